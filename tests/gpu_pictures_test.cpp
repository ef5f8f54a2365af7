// The scenes of shared/ against the pictures that another renderer made of them, where they are there: depth, normal,
// albedo and direct light, all materials pure Lambert. The limits are those of the pictures' README.
#include <algorithm>

#include "gpu_fixture.h"
#include "image/file.h"

namespace nf::test {
namespace {

using glm::vec3;

constexpr uint32_t block = 8;

struct Case {
  const char *folder, *scene, *view;
  const char* direct;  // the picture of sun and lamps alone, where there are any
};
constexpr Case cases[] = {
    {"cornell", "cornell.glb", "cornell_camera.json", nullptr},
    {"fence_sky", "fence.glb", "fence_sky.json", nullptr},
    {"cornell_point", "cornell_nolamp.glb", "cornell_point.json", "direct.exr"},
    {"fence_sun", "fence.glb", "fence_camera.json", "direct_lights.exr"},
    {"gas_station_day", "gas_station.glb", "gas_station_day.json", "direct_lights.exr"},
    {"jungle_sun", "jungle.glb", "jungle_sun.json", "direct_lights.exr"},
    {"breakfast_sun", "breakfast_room.glb", "breakfast_sun.json", "direct.exr"},
    {"sponza_nave", "sponza.glb", "sponza_nave.json", "direct_lights.exr"},
};

image::Image picture(const std::filesystem::path& path) {
  return image::read_exr(path).layers.at(0).image;
}

vec3 color(const image::Image& image, uint32_t x, uint32_t y) {
  return {image.at(x, y, 0), image.at(x, y, 1), image.at(x, y, 2)};
}

// Pixels that show a surface, as their neighbours do: no silhouettes, where pixel centres decide.
std::vector<uint8_t> inside(const image::Image& mask, const image::Image& depth) {
  std::vector<uint8_t> out(size_t(mask.width) * mask.height);
  for (uint32_t y = 0; y < mask.height; ++y)
    for (uint32_t x = 0; x < mask.width; ++x) {
      bool good = mask.at(x, y, 0) > 0.5f;
      const float z = depth.at(x, y, 0);
      for (const glm::ivec2 step : {glm::ivec2(1, 0), glm::ivec2(0, 1)}) {
        const uint32_t x1 = std::min(x + uint32_t(step.x), mask.width - 1),
                       y1 = std::min(y + uint32_t(step.y), mask.height - 1);
        good = good && std::abs(depth.at(x1, y1, 0) - z) < 0.1f * z;
      }
      out[size_t(y) * mask.width + x] = good;
    }
  return out;
}

// Means of the blocks that lie wholly inside.
std::vector<vec3> block_means(const image::Image& image, const std::vector<uint8_t>& good) {
  std::vector<vec3> means;
  for (uint32_t y = 0; y + block <= image.height; y += block)
    for (uint32_t x = 0; x + block <= image.width; x += block) {
      vec3 sum(0);
      bool whole = true;
      for (uint32_t i = 0; i < block * block; ++i) {
        const uint32_t px = x + i % block, py = y + i / block;
        whole = whole && good[size_t(py) * image.width + px];
        sum += color(image, px, py);
      }
      if (whole) means.push_back(sum / float(block * block));
    }
  return means;
}

double relative_rmse(const std::vector<vec3>& test, const std::vector<vec3>& reference) {
  double squares = 0, sum = 0;
  for (size_t i = 0; i < test.size(); ++i)
    for (int c = 0; c < 3; ++c) {
      squares += std::pow(double(test[i][c]) - double(reference[i][c]), 2);
      sum += double(reference[i][c]);
    }
  const double n = double(test.size()) * 3;
  return std::sqrt(squares / n) / (sum / n);
}

std::vector<vec3> divided(std::vector<vec3> light, const std::vector<vec3>& albedo) {
  for (size_t i = 0; i < light.size(); ++i) light[i] /= glm::max(albedo[i], vec3(0.02f));
  return light;
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(values.size() / 2), values.end());
  return values[values.size() / 2];
}

class Pictures : public GpuTest, public testing::WithParamInterface<Case> {};

TEST_P(Pictures, MatchAnotherRenderers) {
  const std::filesystem::path shared = std::filesystem::path(NF_SOURCE_DIR) / "../shared";
  const std::filesystem::path folder = shared / "reference" / GetParam().folder;
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no " << folder;
  scene::Scene scene = scene::load_gltf(shared / "scenes" / GetParam().scene);
  Request request{.size = {320, 180}, .camera = {}, .settings = {}};
  request.camera = scene::select_view(shared / "scenes" / GetParam().view, scene);
  request.settings.technique = &passes::find_technique("none");
  request.settings.material.lambert = request.settings.material.blend = 1;
  request.settings.material.lod_bias = -16;  // theirs have no mips
  request.frames = 2, request.accumulate = true, request.scan = false;
  const Shot shot = shoot(scene, request);

  const image::Image depth = picture(folder / "depth.exr"), normal = picture(folder / "normal.exr"),
                     albedo = picture(folder / "albedo.exr");
  const std::vector<uint8_t> good = inside(picture(folder / "mask.exr"), depth);
  std::vector<double> depth_off, normal_off;
  for (uint32_t y = 0; y < 180; ++y)
    for (uint32_t x = 0; x < 320; ++x) {
      if (!good[size_t(y) * 320 + x]) continue;
      const double z = double(depth.at(x, y, 0));
      depth_off.push_back(std::abs(double(shot.layer("depth").at(x, y, 0)) - z) / z);
      const float cosine = glm::dot(color(normal, x, y), color(shot.layer("normal"), x, y));
      normal_off.push_back(glm::degrees(std::acos(std::min(double(cosine), 1.0))));
    }
  ASSERT_GT(depth_off.size(), 5000u);
  const std::vector<vec3> albedo_here = block_means(shot.layer("albedo"), good),
                          albedo_there = block_means(albedo, good);
  ASSERT_GT(albedo_here.size(), 100u);
  const double albedo_error = relative_rmse(albedo_here, albedo_there);
  std::printf("%-16s %4zu blocks: depth %.4f %%, normal %.3f deg, albedo %.2f %%\n", GetParam().folder,
              albedo_here.size(), 100 * median(depth_off), median(normal_off), 100 * albedo_error);
  EXPECT_LT(median(depth_off), 0.001);
  EXPECT_LT(median(normal_off), 1);
  EXPECT_LT(albedo_error, 0.02);
  if (!GetParam().direct) return;
  const std::vector<vec3> here = block_means(shot.layer("direct_diffuse"), good),
                          there = block_means(picture(folder / GetParam().direct), good);
  const double light = relative_rmse(here, there),
               apart = relative_rmse(divided(here, albedo_here), divided(there, albedo_there));
  std::printf("%-16s direct light %.2f %% (by albedo %.2f %%)\n", GetParam().folder, 100 * light, 100 * apart);
  EXPECT_LT(light, 0.05);
  EXPECT_LT(apart, 0.05);
}

INSTANTIATE_TEST_SUITE_P(Shared, Pictures, testing::ValuesIn(cases),
                         [](const auto& row) { return std::string(row.param.folder); });

}  // namespace
}  // namespace nf::test
