// Whole models of others, where they are there: the scenes of shared/, and Debian's assimp-testmodels.
#include <cmath>
#include <gtest/gtest.h>

#include "scene/gltf.h"
#include "scene/scene.h"
#include "scene_files.h"

namespace {

using namespace nf;
using namespace nf::scene;

void check_tables(const Scene& scene) {
  const Geometry& geometry = scene.geometry;
  for (const Primitive& primitive : scene.primitives) {
    ASSERT_LT(primitive.material, scene.materials.size());
    const bool mapped = scene.materials[primitive.material].normal_texture != none;
    for (uint32_t i = 0; i < primitive.index_count; ++i) {
      const uint32_t index = geometry.index[primitive.first_index + i];
      ASSERT_LT(index, primitive.vertex_count);
      const uint32_t vertex = primitive.vertex_offset + index;
      ASSERT_NEAR(glm::length(geometry.normal[vertex]), 1, 1e-3);
      if (!mapped) continue;
      ASSERT_NEAR(glm::length(vec3(geometry.tangent[vertex])), 1, 1e-3);
      ASSERT_EQ(std::abs(geometry.tangent[vertex].w), 1);
    }
  }
  for (const Picture& picture : scene.pictures) {
    ASSERT_EQ(picture.rgba.size(), size_t(picture.width) * picture.height * 4);
  }
}

TEST(SharedScenes, LoadWithTheKnownTriangles) {
  const std::map<std::string, uint64_t> known = {{"sponza", 115580},        {"jungle", 18515}, {"gas_station", 57220},
                                                 {"breakfast_room", 82291}, {"fence", 3786},   {"cornell", 234}};
  for (const auto& file : test::shared_files(".glb")) {
    SCOPED_TRACE(file.string());
    const Scene scene = load_gltf(file);
    EXPECT_GT(scene.triangles(), 0u);
    const auto count = known.find(file.stem().string());
    if (count != known.end()) {
      EXPECT_EQ(scene.triangles(), count->second);
    }
    const vec3 size = scene.bounds.max - scene.bounds.min;
    EXPECT_TRUE(std::isfinite(glm::length(size)) && glm::length(size) > 0.1f);
    check_tables(scene);
  }
}

double surface(const Scene& scene) {
  double sum = 0;
  for (size_t i = 0; i < scene.instances.size(); ++i) {
    const Primitive& primitive = scene.primitives[scene.instances.primitive[i]];
    const glm::dmat4 world(scene.nodes.world[scene.instances.node[i]]);
    const auto corner = [&](uint32_t k) {
      const uint32_t index = scene.geometry.index[primitive.first_index + k];
      return glm::dvec3(world * glm::dvec4(scene.geometry.position[primitive.vertex_offset + index], 1));
    };
    for (uint32_t k = 0; k < primitive.index_count; k += 3) {
      sum += glm::length(glm::cross(corner(k + 1) - corner(k), corner(k + 2) - corner(k))) / 2;
    }
  }
  return sum;
}

// Debian's assimp-testmodels, where installed: every file loads, or is refused with a reason.
TEST(AssimpModels, LoadOrAreRefused) {
  const std::filesystem::path folder = "/usr/share/assimp/models/glTF2";
  std::error_code missing;
  if (!std::filesystem::exists(folder, missing)) GTEST_SKIP() << "assimp-testmodels is not installed";
  int loaded = 0, refused = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.path().extension() != ".gltf" && entry.path().extension() != ".glb") continue;
    (test::load_error(entry.path()).empty() ? loaded : refused)++;
  }
  EXPECT_GE(loaded, 20);
  EXPECT_GE(refused, 10);
  const Scene plain = load_gltf(folder / "2CylinderEngine-glTF-Binary/2CylinderEngine.glb");
  const Scene draco = load_gltf(folder / "draco/2CylinderEngine.gltf");
  // Draco drops triangles without an area, so areas are compared and not counts.
  EXPECT_NEAR(surface(draco) / surface(plain), 1, 1e-3);
  EXPECT_LT(glm::distance(plain.bounds.max, draco.bounds.max), 0.1f);
  check_tables(draco);
}

}  // namespace
