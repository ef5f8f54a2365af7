// The techniques through the GPU: open planes, what the C++ twins of the slice techniques make of the same texels, vbao
// against gtao, and swaps through all of them.
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>

#include "gpu_fixture.h"
#include "image/ring.h"
#include "reference/reference.h"
#include "scene/camera.h"
#include "scenes.h"
#include "slice_twin.h"

namespace nf::test {
namespace {

using content::Builder;
using glm::ivec2;
using glm::uvec2;
using glm::vec3;

class Techniques : public GpuTest {
 protected:
  std::array<double, 2> errors_behind_bars(const std::filesystem::path& path, const std::filesystem::path& view,
                                           reference::RadiusMode mode, float radius,
                                           const std::vector<const char*>& assignments);
  // The generated scene.
  std::filesystem::path fence();
};

passes::FrameSettings settings_of(const char* technique, const std::vector<const char*>& assignments = {}) {
  passes::FrameSettings settings;
  settings.technique = &passes::find_technique(technique);
  settings.material.lambert = 1;
  for (const char* assignment : assignments) params::assign(settings.blocks(), assignment);
  return settings;
}

TEST_F(Techniques, OpenPlaneReadsOne) {
  Builder b;
  b.quad({-300, 0, 300}, {300, 0, 300}, {300, 0, -300}, {-300, 0, -300}, b.material({.base_color = vec3(0.5f)}));
  const scene::Scene scene = load(b);
  for (const char* id : {"hbao", "gtao", "vbao", "vbgi"})
    for (const char* measure : {"gi.slice_measure=screen_j", "gi.slice_measure=view"})
      for (const float pitch : {-20.0f, -60.0f}) {
        const vec3 forward(0, std::sin(glm::radians(pitch)), -std::cos(glm::radians(pitch)));
        const Shot shot = shoot(scene, {.size = {64, 64},
                                        .camera = look({0, 1.7f, 0}, vec3(0, 1.7f, 0) + forward, 90),
                                        .settings = settings_of(id, {measure, "gi.slices=16", "gi.steps=4"})});
        for (int i = 0; i < 64 * 64; ++i) {
          const ivec2 pixel(i % 64, i / 64);
          if (shot.value("depth", pixel) > 0) {
            EXPECT_NEAR(shot.value("visibility", pixel), 1, 2e-3f) << id << " " << measure << " " << pitch;
          }
        }
      }
}

Builder room() {
  Builder b = small_room();
  b.quad({-1, 0.2f, 1}, {1, 0.2f, 1}, {1, 0.8f, 0.6f}, {-1, 0.8f, 0.6f},
         b.material({.base_color = vec3(0.9f, 0.1f, 0.1f)}));
  return b;
}

// The texels that the technique saw, for its twin.
void feed_twin(const Shot& shot, uvec2 size, const scene::Camera& camera) {
  const float ty = std::tan(camera.vfov * 0.5f), tx = ty * float(size.x) / float(size.y);
  twin::frame.ray_scale = {2 * tx / float(size.x), -2 * ty / float(size.y)};
  twin::frame.ray_offset = {-tx, ty};
  twin::frame.pixels_per_tangent = glm::vec2(size) / (2.0f * glm::vec2(tx, ty));
  twin::frame.size = ivec2(size);
  twin::frame.frame_index = 0, twin::frame.seed = 1;
  const glm::mat3 view_from_world(scene::view_from_world(camera));
  const auto at = [&shot](const char* layer, ivec2 p) {
    return vec3(shot.value(layer, p, 0), shot.value(layer, p, 1), shot.value(layer, p, 2));
  };
  twin::fetch = [=](ivec2 p) {
    const vec3 normal = view_from_world * at("normal", p);
    return bed::Texel{shot.value("depth", p), glm::length(normal) > 0 ? normal : vec3(0, 0, 1), at("radiance", p), {}};
  };
}

// Assigns to the twin what was assigned to the technique.
twin::Params twin_params(const passes::FrameSettings& settings, bool gi) {
  twin::Params out;
  const auto copy = [](const ParamTable& table, const void* data, auto set) {
    for (const Param& p : table.params) set(p.name, params::get(table, data, p));
  };
  const auto set = [&](const char* name, double value) {
#define COPY(type, member, ...) \
  if (std::string_view(name) == #member) out.member = decltype(out.member)(value);
    NF_GI_PARAMS(COPY)
    NF_VBGI_PARAMS(COPY)
#undef COPY
  };
  copy(passes::GiParams::table(), &settings.gi.shared, set);
  if (gi)
    copy(passes::VbgiParams::table(), &settings.gi.vbgi, set);
  else
    copy(passes::VbaoParams::table(), &settings.gi.vbao, set);
  return out;
}

TEST_F(Techniques, TheDeviceAgreesWithTheTwins) {
  const scene::Scene scene = load(room());
  const uvec2 size(40, 24);
  const scene::Camera camera = inside_small_room();
  struct Case {
    const char* technique;
    std::initializer_list<const char*> assignments;
  };
  const Case cases[] = {
      {"vbgi", {}},
      {"vbgi", {"gi.slices=3", "vbgi.sectors=128", "vbgi.emitter=half_space", "gi.radius_mode=ball"}},
      {"vbgi",
       {"vbgi.span=point", "vbgi.sectors=8", "vbgi.sector_rule=ceil", "vbgi.sector_measure=uniform_angle",
        "vbgi.emitter=cosine", "gi.back_along=receiver_v", "gi.projection=view_cosine", "gi.slice_measure=screen"}},
      {"vbgi", {"vbgi.sector_measure=solid_angle", "gi.radius_mode=ball_falloff", "vbgi.sector_rule=centre"}},
      {"vbgi",
       {"vbgi.sector_measure=four_masks", "gi.thickness_mode=linear", "gi.slice_measure=view", "gi.step_jitter=false"}},
      {"vbgi", {"vbgi.span=point", "gi.radius_mode=ball"}},
      {"vbao", {"gi.back_along=receiver_v", "gi.radius_mode=ball_falloff"}},
      {"vbao", {"vbao.sector_measure=sine", "gi.thickness_mode=angular", "gi.step_exponent=1.5"}},
      {"gtao", {"gi.slices=2"}},
      {"gtao", {"gi.projection=view_cosine", "gi.radius_mode=ball_falloff", "gtao.thin_occluder=0.3"}},
      {"hbao", {"hbao.falloff=quadratic", "hbao.bias=10"}},
  };
  for (const Case& c : cases) {
    passes::FrameSettings settings = settings_of(c.technique, {"gi.radius=1.5", "gi.thickness=0.3", "gi.steps=6"});
    std::string label = c.technique;
    for (const char* assignment : c.assignments) {
      params::assign(settings.blocks(), assignment);
      label += std::string(" ") + assignment;
    }
    const Shot shot = shoot(scene, {.size = size, .camera = camera, .settings = settings});
    feed_twin(shot, size, camera);
    const bool bitmask = c.technique[0] == 'v';
    const bool light = std::string_view(c.technique) == "vbgi";
    twin::bitmask = twin_params(settings, light);
    twin::horizon = {};
    if (!bitmask) {
      const bool uniform = c.technique[0] == 'h';
      const auto take = [&](const auto& own) {
        twin::horizon = {own.falloff, own.thin_occluder, own.bias, own.bent, uniform};
      };
      uniform ? take(settings.gi.hbao) : take(settings.gi.gtao);
    }
    double visibility = 0, gi = 0, bent = 0, occluded = 0;
    for (unsigned i = 0; i < size.x * size.y; ++i) {
      const ivec2 p(int(i % size.x), int(i / size.x));
      twin::Gathered expected{};
      if (bitmask) {
        expected = twin::estimate_bitmask(p);
      } else {
        const twin::Openness open = twin::estimate_horizons(p);
        expected.visibility = open.visibility, expected.bent = open.bent;
      }
      visibility += std::abs(double(shot.value("visibility", p)) - double(expected.visibility));
      if (light) gi += std::abs(double(shot.value("gi", p)) - double(expected.gi.x));
      const vec3 world = glm::transpose(glm::mat3(scene::view_from_world(camera))) * expected.bent;
      bent += double(
          glm::length(world - vec3(shot.value("bent", p, 0), shot.value("bent", p, 1), shot.value("bent", p, 2))));
      occluded += 1 - double(expected.visibility);
    }
    const double count = size.x * size.y;
    EXPECT_GT(occluded / count, 0.02) << label;
    // Half floats, and samples on a sector's or a texel's border that round the other way.
    EXPECT_LT(visibility / count, 2e-3) << label;
    EXPECT_LT(gi / count, 6e-3) << label;
    EXPECT_LT(bent / count, 3e-3) << label;
    // The control: other noise is another picture.
    if (!bitmask) continue;
    twin::frame.seed = 2;
    double other = 0;
    for (unsigned i = 0; i < size.x * size.y; ++i) {
      const ivec2 p(int(i % size.x), int(i / size.x));
      other += std::abs(double(shot.value("visibility", p)) - double(twin::estimate_bitmask(p).visibility));
    }
    EXPECT_GT(other / count, 5e-3) << label;
  }
}

// 3.15 items 9 and 14.
TEST_F(Techniques, InfiniteThicknessIsGtaoAndSectorCountsConverge) {
  const scene::Scene scene = load(room());
  const auto visibility = [&](const char* id, std::initializer_list<const char*> assignments) {
    passes::FrameSettings settings = settings_of(id, {"gi.thickness_mode=infinite", "gi.slices=2", "gi.radius=2"});
    for (const char* assignment : assignments) params::assign(settings.blocks(), assignment);
    return shoot(
               scene,
               {.size = {64, 36}, .camera = inside_small_room(), .settings = settings, .frames = 8, .accumulate = true})
        .layer("visibility");
  };
  const auto apart = [](const image::Image& a, const image::Image& b) {
    double sum = 0;
    for (size_t i = 0; i < a.pixels.size(); ++i) sum += std::abs(double(a.pixels[i]) - double(b.pixels[i]));
    return sum / double(a.pixels.size());
  };
  const image::Image gtao = visibility("gtao", {}), fine = visibility("vbao", {"vbao.sectors=128", "vbao.span=point"});
  EXPECT_LT(apart(gtao, fine), 2.0 / 255);
  const double at_64 = apart(fine, visibility("vbao", {"vbao.sectors=64", "vbao.span=point"})),
               at_8 = apart(fine, visibility("vbao", {"vbao.sectors=8", "vbao.span=point"}));
  EXPECT_LT(at_64, 4e-3);
  EXPECT_LT(at_64, at_8);
  EXPECT_GT(apart(gtao, visibility("vbao", {"vbao.sectors=128", "gi.thickness_mode=constant"})), 2.0 / 255)
      << "control";
}

// RMSE of visibility on the wall within a few texels of the bars in front of it, of vbao and gtao with the same
// settings. The truth is path traced, with the same radius.
std::array<double, 2> Techniques::errors_behind_bars(const std::filesystem::path& path,
                                                     const std::filesystem::path& view, reference::RadiusMode mode,
                                                     float radius, const std::vector<const char*>& assignments) {
  scene::Scene scene = scene::load_gltf(path);
  const uvec2 size(160, 90);
  const scene::Camera camera = scene::select_view(view, scene);
  reference::Tracer tracer(
      scene, {.camera = camera, .size = size, .radius = radius, .radius_mode = mode, .lambert = true}, {"visibility"});
  tracer.sample(64);
  const std::vector<image::Layer> layers = tracer.layers();
  const image::Image& truth =
      std::find_if(layers.begin(), layers.end(), [](const image::Layer& l) { return l.name == "visibility"; })->image;
  const auto render = [&](const char* id) {
    return shoot(
        scene,
        {.size = size, .camera = camera, .settings = settings_of(id, assignments), .frames = 8, .accumulate = true});
  };
  const Shot vbao = render("vbao"), gtao = render("gtao");
  const std::vector<uint8_t> ring = image::ring_behind(vbao.layer("depth").pixels, size.x, 4, 0.2f);
  double error[2] = {0, 0};
  int count = 0;
  for (int y = 4; y < 86; ++y)
    for (int x = 4; x < 156; ++x) {
      if (!ring[size_t(y) * size.x + size_t(x)]) continue;
      const auto off = [&](const Shot& shot) {
        return double(shot.value("visibility", {x, y})) - double(truth.at(uint32_t(x), uint32_t(y), 0));
      };
      error[0] += off(vbao) * off(vbao), error[1] += off(gtao) * off(gtao);
      ++count;
    }
  EXPECT_GT(count, 200);
  const std::array<double, 2> rmse = {std::sqrt(error[0] / count), std::sqrt(error[1] / count)};
  std::printf("visibility behind bars, %d texels, RMSE: vbao %.4f, gtao %.4f\n", count, rmse[0], rmse[1]);
  return rmse;
}

std::filesystem::path Techniques::fence() {
  const std::filesystem::path path = temporary("fence.glb");
  const std::vector<uint8_t> bytes = content::fence();
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
  return path;
}

// Behind the bars of a fence: a horizon takes each bar for a wall.
TEST_F(Techniques, ThinBarsDarkenTheWallBehindLessWithBitmasks) {
  const auto compare = [&](const std::filesystem::path& path, const std::filesystem::path& view) {
    const auto [vbao, gtao] =
        errors_behind_bars(path, view, reference::RadiusMode::Ball, 2,
                           {"gi.radius=2", "gi.radius_mode=ball", "gi.slices=2", "gi.thickness=0.03"});
    EXPECT_LE(vbao, 0.6 * gtao) << path;
  };
  compare(fence(), "");
  const std::filesystem::path shared = std::filesystem::path(NF_SOURCE_DIR) / "../shared/scenes";
  if (std::filesystem::exists(shared)) compare(shared / "fence.glb", shared / "fence_camera.json");
}

// The defaults take everything for 0.2 m thick, bars too; told how thick they are, the same few steps do as dense ones
// do.
TEST_F(Techniques, ThinBarsWithTheDefaults) {
  const float radius = passes::GiParams{}.radius;
  const auto [vbao, gtao] = errors_behind_bars(fence(), "", reference::RadiusMode::Disc, radius, {});
  EXPECT_LE(vbao, 0.85 * gtao);
  const double thin = errors_behind_bars(fence(), "", reference::RadiusMode::Disc, radius, {"gi.thickness=0.03"})[0];
  EXPECT_LE(thin, 0.6 * gtao);
}

// Every technique in every form, a new one every few frames, among them sizes that no group fills: silent (TearDown)
// and finite.
TEST_F(Techniques, SwapsThroughAllAndTheirModes) {
  const scene::Scene scene = load(small_room());
  passes::Renderer renderer(device(), scene);
  std::vector<passes::FrameSettings> all;
  for (const passes::Technique& technique : passes::techniques()) {
    all.push_back(settings_of(technique.id));
    if (technique.paper_mode.empty()) continue;
    all.push_back(settings_of(technique.id));
    passes::set_paper_mode(all.back());
  }
  const uvec2 sizes[] = {{32, 18}, {3, 5}, {1, 1}};
  uint32_t channels = 0, finite = 0;
  for (uint32_t frame = 0; frame < 300; ++frame) {
    const passes::FrameSettings& settings = all[frame / 3 % all.size()];
    passes::FrameView view;
    view.size = sizes[frame / 3 / all.size() % 3];
    view.camera = view.previous_camera = inside_small_room();
    view.frame_index = frame;
    graph::Graph graph(renderer.executor().histories());
    const passes::FrameOutputs out = renderer.build(graph, view, settings);
    graph.readback("lit", out.lit);
    if (out.gi.gi) graph.readback("gi", out.gi.gi);
    if (out.gi.visibility) graph.readback("visibility", out.gi.visibility);
    renderer.executor().run(graph);
    for (const graph::Readback& back : renderer.executor().take_readbacks())
      for (const float x : graph::to_floats(back, channels)) {
        ASSERT_TRUE(std::isfinite(x)) << settings.technique->id << " frame " << frame;
        ++finite;
      }
  }
  EXPECT_GT(finite, 10000u);
  std::printf("%zu forms of %zu techniques\n", all.size(), passes::techniques().size());
}

}  // namespace
}  // namespace nf::test
