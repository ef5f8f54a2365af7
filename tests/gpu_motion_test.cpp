// Things that move, on the device: skinned and morphed vertices against the CPU's, velocities against projected motion,
// textures with transforms and second coordinates.
#include "core/log.h"
#include "gpu_fixture.h"
#include "moving_files.h"
#include "scene/animation.h"
#include "scene/camera.h"
#include "scene/deform.h"

namespace nf::test {
namespace {

using glm::vec2;
using glm::vec3;

class Motion : public GpuTest {
 protected:
  struct Result {
    std::vector<float> velocity, depth, albedo;
    uint32_t channels = 0, albedo_channels = 0;
    std::vector<std::byte> deformed;
    vec2 velocity_at(glm::uvec2 pixel, uint32_t width) const {
      const size_t i = (pixel.y * width + pixel.x) * channels;
      return {velocity[i], velocity[i + 1]};
    }
  };
  // The scene at `from`, one frame; then at `to`, the frame that is looked at.
  static Result move(scene::Scene& scene, const scene::Camera& camera, glm::uvec2 size, double from, double to) {
    scene::animate(scene, from);
    passes::Renderer renderer(device(), scene);
    passes::FrameView view;
    view.camera = view.previous_camera = camera;
    view.size = size;
    Result result;
    for (const double time : {from, to}) {
      renderer.update(scene::animate(scene, time));
      graph::Graph graph(renderer.executor().histories());
      const passes::FrameOutputs out = renderer.build(graph, view, {});
      for (const char* name : {"velocity", "depth", "albedo"})
        graph.readback(name, renderer.add_layer(graph, out, passes::find_aov(name)));
      for (uint16_t r = 0; r < graph.resources.size(); ++r)
        if (!std::strcmp(graph.resources[r].name, "deform.vertices") && !graph.resources[r].imported) {
          graph.readback("deformed", graph.buf(r));
          break;
        }
      renderer.executor().run(graph);
      const auto readbacks = renderer.executor().take_readbacks();
      uint32_t ignored = 0;
      result.velocity = graph::to_floats(readbacks[0], result.channels);
      result.depth = graph::to_floats(readbacks[1], ignored);
      result.albedo = graph::to_floats(readbacks[2], result.albedo_channels);
      if (readbacks.size() > 3) result.deformed = readbacks[3].texels;
      ++view.frame_index;
    }
    return result;
  }

  // In pixels, y down.
  static vec2 project(const scene::Camera& camera, glm::uvec2 size, vec3 world) {
    const glm::vec4 clip = scene::clip_from_view(camera, size) * scene::view_from_world(camera) * glm::vec4(world, 1);
    return (vec2(clip) / clip.w * 0.5f + 0.5f) * vec2(size);
  }

  static void expect_deformed(const scene::Scene& scene, const Result& result) {
    size_t row = 0, moved = 0;
    for (uint32_t i = 0; i < scene.instances.size(); ++i) {
      const scene::Primitive& p = scene.primitives[scene.instances.primitive[i]];
      if (scene.instances.skin[i] == scene::none && p.target_count == 0) continue;
      const scene::Deformed now = scene::deform(scene, i, scene::Moment::Now),
                            before = scene::deform(scene, i, scene::Moment::Before);
      for (size_t v = 0; v < now.position.size(); ++v, ++row) {
        float got[13];
        ASSERT_LE((row + 1) * sizeof got, result.deformed.size());
        std::memcpy(got, result.deformed.data() + row * sizeof got, sizeof got);
        for (int c = 0; c < 3; ++c) {
          EXPECT_NEAR(got[c], now.position[v][c], 1e-5f) << "vertex " << v;
          EXPECT_NEAR(got[3 + c], before.position[v][c], 1e-5f) << "vertex " << v;
          EXPECT_NEAR(got[6 + c], now.normal[v][c], 1e-5f) << "vertex " << v;
          EXPECT_NEAR(got[9 + c], now.tangent[v][c], 1e-5f) << "vertex " << v;
        }
        moved += glm::distance(now.position[v], before.position[v]) > 1e-3f;
      }
    }
    EXPECT_EQ(row * 52, result.deformed.size());
    EXPECT_GT(moved, 0u) << "control: something moved";
  }
};

TEST_F(Motion, SkinnedVerticesAreTheCpus) {
  scene::Scene scene = load_binary(arm_file());
  expect_deformed(scene, move(scene, look({0.5f, 1, 4}, {0.5f, 1, 0}, 60), {64, 64}, 0.3, 0.35));
}

TEST_F(Motion, MorphedVerticesAreTheCpus) {
  scene::Scene scene = load_binary(morph_file());
  expect_deformed(scene, move(scene, look({0.5f, 1, 4}, {0.5f, 1, 0}, 60), {64, 64}, 0.3, 0.5));
}

// A point of the arm's upper half, inside a triangle: its motion is that of the vertices' mean with the same weights.
TEST_F(Motion, VelocityOfASkinnedPoint) {
  scene::Scene scene = load_binary(arm_file());
  const scene::Camera camera = look({0.5f, 1, 4}, {0.5f, 1, 0}, 60);
  const glm::uvec2 size(256, 256);
  const Result result = move(scene, camera, size, 0.3, 0.32);
  const scene::Deformed now = scene::deform(scene, 0, scene::Moment::Now),
                        before = scene::deform(scene, 0, scene::Moment::Before);
  int tried = 0;
  for (const auto& corner : {std::array<size_t, 3>{2, 5, 4}, {2, 3, 5}, {0, 3, 2}})
    for (const vec3 weight : {vec3(0.2f, 0.4f, 0.4f), vec3(0.4f, 0.3f, 0.3f), vec3(0.3f, 0.5f, 0.2f)}) {
      const auto at = [&](const std::vector<vec3>& p, vec3 w) {
        return w.x * p[corner[0]] + w.y * p[corner[1]] + w.z * p[corner[2]];
      };
      // The weights of the pixel's centre: solved from the projected triangle (the arm stays in a plane that faces the
      // camera, so they are affine).
      const glm::uvec2 pixel(project(camera, size, at(now.position, weight)));
      const vec2 a = project(camera, size, now.position[corner[0]]), b = project(camera, size, now.position[corner[1]]),
                 c = project(camera, size, now.position[corner[2]]), p = vec2(pixel) + 0.5f;
      const glm::vec2 bc = glm::inverse(glm::mat2(b - a, c - a)) * (p - a);
      const vec3 w(1 - bc.x - bc.y, bc.x, bc.y);
      const vec2 expected = project(camera, size, at(now.position, w)) - project(camera, size, at(before.position, w));
      const vec2 got = result.velocity_at(pixel, size.x);
      EXPECT_NEAR(got.x, expected.x, 0.05f);
      EXPECT_NEAR(got.y, expected.y, 0.05f);
      tried += glm::length(expected) > 0.5f;
    }
  EXPECT_GE(tried, 3) << "control: it moved";
}

TEST_F(Motion, VelocityOfAMovingBox) {
  content::Builder b;
  const content::ObjectId box = b.object("box");
  b.box(vec3(0), vec3(0.5f), 0, b.material({.base_color = vec3(1)}));
  b.animate_translation(box, {0, 1}, {vec3(0), vec3(1, 0.5f, 0)});
  scene::Scene scene = load(b);
  const scene::Camera camera = look({0, 0, 3}, {0, 0, 0}, 60);
  const glm::uvec2 size(128, 128);
  const Result result = move(scene, camera, size, 0.2, 0.25);
  // The face towards the camera, at z = 0.5.
  const vec3 from(0.2f, 0.1f, 0.5f), step(0.05f, 0.025f, 0);
  const vec2 expected = project(camera, size, from + step) - project(camera, size, from);
  const glm::uvec2 pixel(project(camera, size, from + step));
  EXPECT_NEAR(result.velocity_at(pixel, size.x).x, expected.x, 0.05f);
  EXPECT_NEAR(result.velocity_at(pixel, size.x).y, expected.y, 0.05f);
  EXPECT_GT(glm::length(expected), 1.0f);
  EXPECT_NEAR(result.depth[pixel.y * size.x + pixel.x], 2.5f, 1e-3f);
  // What rests has none: the same frame again.
  scene::Scene resting = load(b);
  const Result still = move(resting, camera, size, 0.25, 0.25);
  EXPECT_EQ(still.velocity_at(pixel, size.x), vec2(0));
}

}  // namespace
}  // namespace nf::test
