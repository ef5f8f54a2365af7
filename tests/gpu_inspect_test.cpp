// One pixel taken apart: the records of its samples add up to what the technique gives there, at any form and
// resolution, and asking for them changes nothing.
#include <bit>
#include <cmath>

#include "gpu_fixture.h"
#include "scenes.h"

namespace nf::test {
namespace {

using glm::ivec2;
using glm::uvec2;
using glm::vec3;

class Inspect : public GpuTest {
 protected:
  struct Looked {
    passes::Inspection inspection;
    std::map<std::string, image::Image> layers;
  };
  Looked look_into(passes::Renderer& renderer, passes::FrameView view, const passes::FrameSettings& settings) {
    graph::Graph graph(renderer.executor().histories());
    const passes::FrameOutputs outputs = renderer.build(graph, view, settings);
    Looked out;
    std::vector<std::string> names;
    for (const char* name : {"visibility", "gi"})
      if (const graph::Tex tex = renderer.add_layer(graph, outputs, passes::find_aov(name))) {
        graph.readback("layer", tex);
        names.emplace_back(name);
      }
    if (view.inspect) graph.readback("inspection", outputs.inspection.records);
    renderer.executor().run(graph);
    renderer.executor().finish();
    const std::vector<graph::Readback> readbacks = renderer.executor().take_readbacks();
    for (size_t i = 0; i < names.size(); ++i) {
      image::Image& image = out.layers[names[i]];
      image = {readbacks[i].desc.size.width, readbacks[i].desc.size.height, 0, {}};
      image.pixels = graph::to_floats(readbacks[i], image.channels);
    }
    if (view.inspect) out.inspection = passes::read_inspection(outputs.inspection, readbacks.back());
    return out;
  }
  static passes::FrameView inside(uvec2 size) {
    passes::FrameView view = view_of_small_room(size);
    view.averaged = false;
    return view;
  }
  static content::Builder room() {
    content::Builder b = small_room();
    b.quad({-1, 0.2f, 1}, {1, 0.2f, 1}, {1, 0.8f, 0.6f}, {-1, 0.8f, 0.6f},
           b.material({.base_color = vec3(0.9f, 0.1f, 0.1f)}));
    return b;
  }
};

passes::FrameSettings settings_of(const char* technique, std::initializer_list<const char*> assignments) {
  passes::FrameSettings settings;
  settings.technique = &passes::find_technique(technique);
  for (const char* assignment : {"gi.radius=1.5", "gi.thickness=0.3", "gi.steps=8", "gi.slices=2"})
    params::assign(settings.blocks(), assignment);
  for (const char* assignment : assignments) params::assign(settings.blocks(), assignment);
  return settings;
}

float largest(vec3 v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

TEST_F(Inspect, RecordsAddUpToThePixel) {
  const scene::Scene scene = load(room());
  passes::Renderer renderer(device(), scene);
  const uvec2 size(40, 24);
  struct Case {
    const char* technique;
    std::initializer_list<const char*> assignments;
  };
  const Case cases[] = {
      {"vbao", {}},
      {"vbgi", {}},
      {"vbgi", {"vbgi.sectors=128", "vbgi.emitter=half_space", "gi.radius_mode=ball"}},
      {"vbgi",
       {"vbgi.sectors=8", "vbgi.sector_rule=round", "vbgi.sector_measure=uniform_angle", "vbgi.emitter=cosine",
        "gi.back_along=receiver_v", "gi.projection=view_cosine", "gi.slice_measure=screen"}},
      {"vbgi", {"vbgi.sector_measure=solid_angle", "gi.radius_mode=ball_falloff"}},
      {"vbao", {"vbao.sector_measure=four_masks", "gi.slice_measure=view", "gi.radius_mode=ball_falloff"}},
      {"gtao", {}},
      {"gtao", {"gi.projection=view_cosine", "gi.slice_measure=screen", "gtao.thin_occluder=0.3"}},
      {"gtao", {"gi.projection=view_cosine", "gi.radius_mode=ball_falloff", "gi.slice_measure=view"}},
      {"hbao", {"hbao.falloff=quadratic", "hbao.bias=10"}},
      {"hbao", {"gi.radius_mode=ball"}},
      {"hbil", {}},
      {"hbil", {"hbil.space=local"}},
      {"hbil", {"hbil.space=local", "hbil.printed_sign=true", "hbil.reject=running"}},
      {"hbil", {"hbil.reject=code"}},
      {"ssao", {}},
      {"ssao", {"ssao.kernel=chapman", "ssao.range=quadratic", "ssao.self=bias", "ssao.damping=0.05"}},
      {"ssdo", {}},
      {"ssdo", {"ssdo.directions=uniform", "ssdo.sender=clamped", "ssdo.fade=0.25"}},
      {"raymarch", {"raymarch.rays=12"}},
      {"raymarch", {"raymarch.rays=7", "raymarch.hit=inside", "gi.thickness_mode=linear"}},
  };
  for (const Case& c : cases) {
    const passes::FrameSettings settings = settings_of(c.technique, c.assignments);
    std::string label = c.technique;
    for (const char* assignment : c.assignments) label += std::string(" ") + assignment;
    passes::FrameView view = inside(size);
    const Looked plain = look_into(renderer, view, settings);
    double occluded = 0, lit = 0, without_last = 0;
    for (const uvec2 pixel : {uvec2(3, 20), uvec2(20, 12), uvec2(21, 17), uvec2(36, 4), uvec2(0, 0)}) {
      view.inspect = pixel;
      const Looked looked = look_into(renderer, view, settings);
      passes::Inspection seen = looked.inspection;
      ASSERT_EQ(seen.pixel, ivec2(pixel));
      const size_t rays = std::string_view(c.technique) == "raymarch" ? size_t(settings.gi.raymarch.rays) : 1;
      ASSERT_EQ(seen.slices.size(), seen.sectors < 0 ? rays : 2u) << label;
      // The shader's own sums, before they are rounded to half floats.
      EXPECT_NEAR(seen.summed_visibility(), seen.visibility, 1e-4f) << label;
      EXPECT_LE(largest(seen.summed_gi() - seen.gi), 1e-4f + 1e-3f * largest(seen.gi)) << label;
      EXPECT_NEAR(plain.layers.at("visibility").at(pixel.x, pixel.y, 0), seen.visibility, 1e-3f) << label;
      if (plain.layers.contains("gi")) {
        for (uint32_t channel = 0; channel < 3; ++channel)
          EXPECT_NEAR(plain.layers.at("gi").at(pixel.x, pixel.y, channel), seen.gi[int(channel)],
                      1e-3f + 2e-3f * largest(seen.gi))
              << label;
      }
      for (const auto& [name, image] : plain.layers) EXPECT_EQ(looked.layers.at(name).pixels, image.pixels) << label;
      occluded += double(1 - seen.visibility);
      lit += double(largest(seen.gi));
      // Bits: what is new was not there before, and what was there is what came before.
      std::vector<std::array<uint32_t, 4>> masks(seen.slices.size());
      for (const passes::InspectedSample& sample : seen.samples) {
        std::array<uint32_t, 4>& mask = masks[size_t(sample.slice)];
        bool any = false;
        for (size_t word = 0; word < 4; ++word) {
          if (sample.reason != passes::InspectReason::OffScreen) {
            EXPECT_EQ(sample.before[word], mask[word]) << label;
          }
          EXPECT_EQ(sample.fresh[word] & mask[word], 0u);
          mask[word] |= sample.fresh[word];
          any |= sample.fresh[word] != 0;
        }
        EXPECT_EQ(seen.sectors > 0 ? any : sample.taken != 0, sample.reason == passes::InspectReason::Counted) << label;
      }
      // The control: without one sample that counts the sum is another.
      for (size_t i = seen.samples.size(); i-- > 0;)
        if (seen.samples[i].taken > 0) {
          seen.samples.erase(seen.samples.begin() + long(i));
          break;
        }
      without_last += double(std::abs(seen.summed_visibility() - seen.visibility));
    }
    EXPECT_GT(occluded, 0.3) << label;
    EXPECT_GT(without_last, 0.01) << label << ": the sums would not notice a lost sample";
    if (plain.layers.contains("gi")) {
      EXPECT_GT(lit, 0.001) << label;
    }
  }
}

// Of small pictures and overscan, too: the texels are those of the whole picture.
TEST_F(Inspect, FindsThePixelAtAnyResolution) {
  const scene::Scene scene = load(room());
  passes::Renderer renderer(device(), scene);
  const uvec2 pixel(21, 17);
  for (const char* assignment : {"resolution.gi=full", "resolution.gi=half", "resolution.overscan=10"}) {
    passes::FrameSettings settings = settings_of("vbgi", {});
    settings.reconstruct = true;
    settings.switch_off_reconstruction();
    params::assign(settings.blocks(), assignment);
    passes::FrameView view = inside({40, 24});
    view.inspect = pixel;
    const passes::Inspection seen = look_into(renderer, view, settings).inspection;
    EXPECT_LE(largest(vec3(ivec2(pixel) - seen.pixel, 0)), 1) << assignment;
    EXPECT_NEAR(seen.summed_visibility(), seen.visibility, 1e-4f) << assignment;
    ASSERT_FALSE(seen.samples.empty());
    // Where a sample lies in space is where its texel is in the picture.
    const float tangent = std::tan(view.camera.vfov * 0.5f);
    for (const passes::InspectedSample& sample : seen.samples) {
      if (sample.depth <= 0) continue;
      const vec3 at = seen.ray * seen.depth + sample.towards;
      const glm::vec2 ndc = glm::vec2(at.x, -at.y) / (-at.z * tangent) / glm::vec2(40.0f / 24.0f, 1);
      const glm::vec2 texel = (ndc * 0.5f + 0.5f) * glm::vec2(40, 24) - 0.5f;
      EXPECT_LE(glm::length(texel - glm::vec2(sample.texel)), 0.02f) << assignment;
    }
  }
}

TEST_F(Inspect, TheSkyHasNoSamples) {
  content::Builder b;
  b.quad({-1, -1, -3}, {1, -1, -3}, {1, -0.5f, -3}, {-1, -0.5f, -3}, b.material({.base_color = vec3(0.5f)}));
  const scene::Scene scene = load(b);
  passes::Renderer renderer(device(), scene);
  passes::FrameView view = inside({16, 16});
  view.camera = view.previous_camera = look({0, 0, 0}, {0, 0, -1}, 60);
  view.inspect = uvec2(8, 2);
  const passes::Inspection seen = look_into(renderer, view, settings_of("vbgi", {})).inspection;
  EXPECT_EQ(seen.depth, 0);
  EXPECT_TRUE(seen.samples.empty());
  EXPECT_EQ(seen.summed_visibility(), 1);
}

}  // namespace
}  // namespace nf::test
