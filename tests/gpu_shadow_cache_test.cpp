// Kept shadow maps: the picture has the very bytes of maps drawn in every frame, whatever moves or changes; what rests
// costs no pass; and a map that was not drawn anew when it should have been is seen.
#include <set>

#include "gpu_fixture.h"
#include "scene/animation.h"

namespace nf::test {
namespace {

using content::Builder;
using content::ObjectId;
using glm::vec3;

// A court with a box to move, a masked plate, a banner on joints, a lamp that can be moved, a spot light and a sun. It
// is animated: the banner swings from second 10 to second 12, and rests before and after.
Builder court() {
  Builder b;
  const auto white = b.material({.base_color = vec3(0.8f)});
  const auto cut = b.material({.base_color = vec3(0.4f, 0.7f, 0.3f), .alpha_cutoff = 0.5f, .double_sided = true});
  const auto glass = b.material({.base_color = vec3(0.5f, 0.6f, 0.9f), .double_sided = true});
  b.object("floor");
  b.grid({-6, 0, 6}, {6, 0, 6}, {6, 0, -6}, {-6, 0, -6}, 4, 4, white);
  b.object("box");
  b.box({0, 0.5f, 0}, vec3(0.4f, 0.5f, 0.4f), 0.3f, white);
  b.object("plate");
  b.quad({-2, 0.5f, 0}, {-1, 0.5f, 0}, {-1, 1.5f, -0.3f}, {-2, 1.5f, -0.3f}, cut);
  b.object("pane");
  b.quad({1.2f, 0.2f, 0.6f}, {2, 0.2f, 0.6f}, {2, 1.2f, 0.6f}, {1.2f, 1.2f, 0.6f}, glass);
  std::vector<ObjectId> joints = {b.object("joint", {{0, 2, -1.5f}})};
  joints.push_back(b.object("joint below", {{0, -0.6f, 0}}, joints[0]));
  b.animate_rotation(joints[0], {10, 11, 12},
                     {{1, 0, 0, 0}, glm::angleAxis(0.5f, vec3(0, 0, 1)), glm::quat(1, 0, 0, 0)});
  const ObjectId banner = b.object("banner");
  b.grid({-0.5f, 0.8f, -1.5f}, {0.5f, 0.8f, -1.5f}, {0.5f, 2, -1.5f}, {-0.5f, 2, -1.5f}, 2, 6, cut);
  b.skin(banner, joints, [](vec3 p) { return content::JointPair{0, 1, std::clamp((2 - p.y) / 1.2f, 0.0f, 1.0f)}; });
  const ObjectId lamp = b.object("lamp", {{1.5f, 1.6f, -1}});
  b.point_light({0, 0, 0}, 6, vec3(1), lamp);
  b.spot_light({-1.5f, 2.5f, 1.5f}, {0.4f, -1, -0.4f}, 12, 20, 35);
  b.directional_light({0.3f, -1, -0.4f}, 3);
  return b;
}

class ShadowCache : public GpuTest {
 protected:
  void SetUp() override {
    scene = load(court());
    for (scene::Material& m : scene.materials)
      if (m.base_color.z > 0.85f) m.alpha = scene::AlphaMode::Blend, m.base_color.w = 0.5f;
    scene::animate(scene, 0);
    settings.technique = &passes::find_technique("none");
    settings.shadow.resolution = 256;
    settings.shadow.tile_resolution = 128;
    view.camera = view.previous_camera = look({0.5f, 1.8f, 4}, {0, 0.6f, 0}, 60);
    view.size = {96, 54};
    renderer = std::make_unique<passes::Renderer>(device(), scene);
    plain = std::make_unique<passes::Renderer>(device(), scene);
  }
  void TearDown() override {
    renderer.reset();
    plain.reset();
    GpuTest::TearDown();
  }

  struct Frame {
    std::vector<std::byte> direct, picture;
    std::multiset<std::string> shadow_passes;
    bool operator==(const Frame& f) const { return direct == f.direct && picture == f.picture; }
  };
  Frame render(passes::Renderer& with, bool cache, std::span<const graph::HistoryState> histories) {
    settings.shadow.cache = cache;
    graph::Graph graph(histories);
    const passes::FrameOutputs out = with.build(graph, view, settings);
    graph.readback("direct", with.add_layer(graph, out, passes::find_aov("direct")));
    graph.readback("picture", with.add_picture(graph, out, settings));
    with.executor().run(graph);
    Frame frame;
    for (const graph::PassTime& pass : with.executor().finish().passes)
      if (const std::string name = pass.name; name.starts_with("shadow.")) frame.shadow_passes.insert(name);
    const auto readbacks = with.executor().take_readbacks();
    frame.direct = readbacks[0].texels, frame.picture = readbacks[1].texels;
    return frame;
  }
  // The next frame by both renderers, `changes` having been made to the scene; true when they are the same.
  ::testing::AssertionResult same(const char* what, const scene::Changes& changes = {}) {
    renderer->update(changes);
    plain->update(changes);
    kept = render(*renderer, true, renderer->executor().histories());
    drawn = render(*plain, false, plain->executor().histories());
    view.previous_camera = view.camera;
    ++view.frame_index;
    if (kept == drawn) return ::testing::AssertionSuccess();
    return ::testing::AssertionFailure() << "not the same picture: " << what;
  }
  scene::Changes place(const char* name, vec3 at) {
    for (uint32_t i = 0; i < scene.nodes.size(); ++i)
      if (scene.nodes.name[i] == name) scene::set_local(scene.nodes, i, at, {1, 0, 0, 0}, vec3(1));
    return scene::update(scene);
  }
  // Rests until nothing counts as moving; the blended pane always does.
  void rest() {
    for (int i = 0; i < 18; ++i) ASSERT_TRUE(same("at rest", scene::update(scene)));
  }
  size_t count(const char* name) const { return kept.shadow_passes.count(name); }

  scene::Scene scene;
  passes::FrameView view;
  passes::FrameSettings settings;
  std::unique_ptr<passes::Renderer> renderer, plain;
  Frame kept, drawn;
};

TEST_F(ShadowCache, AStillSceneDrawsItsMapsOnce) {
  settings.material.blend = 1;  // cut out: nothing is drawn in every frame
  ASSERT_TRUE(same("first"));
  EXPECT_GT(count("shadow.sun_opaque"), 0u);
  EXPECT_EQ(count("shadow.tile_opaque"), 7u);
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(same("still", scene::animate(scene, i * 0.1)));
    EXPECT_TRUE(kept.shadow_passes.empty()) << *kept.shadow_passes.begin();
    EXPECT_GT(drawn.shadow_passes.size(), 8u);
  }
  // The shadows are there: without them the picture is another.
  const Frame with = kept;
  settings.shadow.enabled = 0;
  ASSERT_TRUE(same("off"));
  EXPECT_NE(with.direct, kept.direct);
  settings.shadow.enabled = 1;
  ASSERT_TRUE(same("on again"));
  EXPECT_GT(count("shadow.sun_opaque"), 0u) << "a frame without the maps: they are gone";
}

TEST_F(ShadowCache, WhateverChangesThePictureIsTheSame) {
  ASSERT_TRUE(same("first"));
  const Frame before = kept;
  ASSERT_TRUE(same("a box moved", place("box", {0.4f, 0.2f, 0.1f})));
  EXPECT_NE(before.direct, kept.direct);
  for (int i = 1; i < 4; ++i)
    ASSERT_TRUE(same("a box goes on moving", place("box", {0.4f + 0.1f * float(i), 0.2f, 0})));
  EXPECT_EQ(count("shadow.sun_opaque"), 0u) << "what rests beside it is kept";
  EXPECT_GT(count("shadow.sun_moving"), 0u);
  rest();
  EXPECT_EQ(count("shadow.sun_opaque"), 0u);

  scene.directional[0].direction = glm::normalize(vec3(-0.2f, -1, -0.5f));
  ASSERT_TRUE(same("the sun"));
  EXPECT_GT(count("shadow.sun_opaque"), 0u);
  EXPECT_EQ(count("shadow.tile_opaque"), 0u) << "the lamps do not care";
  for (int i = 0; i < 5; ++i) {
    view.camera = look({0.5f + 0.3f * float(i), 1.8f, 4}, {0.1f * float(i), 0.6f, 0}, 60);
    ASSERT_TRUE(same("the camera"));
    EXPECT_EQ(count("shadow.tile_opaque"), 0u);
  }
  ASSERT_TRUE(same("a lamp", place("lamp", {1.2f, 1.8f, -0.6f})));
  EXPECT_GT(count("shadow.tile_opaque"), 0u);
  scene.punctual[0].radius = 0.1f;
  ASSERT_TRUE(same("the lamp's size"));
  for (int i = 0; i < 6; ++i) ASSERT_TRUE(same("a banner on joints", scene::animate(scene, 10.2 + 0.3 * i)));
  ASSERT_TRUE(same("the banner has come to rest", scene::animate(scene, 13)));
  rest();

  // Moved and at rest again while nobody looked.
  scene::Changes changes = place("box", {-0.5f, 0.3f, 0.4f});
  for (int i = 0; i < 20; ++i) {
    renderer->update(changes);
    plain->update(changes);
    changes = scene::update(scene);
  }
  ASSERT_TRUE(same("behind one's back"));
  EXPECT_GT(count("shadow.sun_opaque"), 0u);
  ASSERT_TRUE(same("still"));
  EXPECT_EQ(count("shadow.sun_opaque"), 0u);

  settings.shadow.two_sided = 0;
  ASSERT_TRUE(same("two_sided"));
  EXPECT_GT(count("shadow.sun_opaque"), 0u);
  settings.shadow.resolution = 128;
  ASSERT_TRUE(same("resolution"));
  settings.shadow.cascades = 2;
  ASSERT_TRUE(same("cascades"));
  settings.shadow.tiles = 3;
  ASSERT_TRUE(same("tiles"));
  settings.shadow.bias = 0.3f;
  ASSERT_TRUE(same("bias"));
  EXPECT_EQ(count("shadow.sun_opaque"), 0u) << "not the maps' business";
  settings.material.blend = 1;
  ASSERT_TRUE(same("blending"));
  settings.technique = &passes::find_technique("vbao");
  ASSERT_TRUE(same("the technique"));
  EXPECT_EQ(count("shadow.sun_opaque"), 0u) << "not the maps' business either";
  view.size = {80, 45};
  ASSERT_TRUE(same("the size"));
  renderer->executor().invalidate_histories();
  plain->executor().invalidate_histories();
  ASSERT_TRUE(same("invalidated"));
  EXPECT_GT(count("shadow.sun_opaque"), 0u);
  for (const uint64_t seed : {3, 4, 0}) {
    renderer->executor().options.order_seed = plain->executor().options.order_seed = seed;
    ASSERT_TRUE(same("another order"));
    ASSERT_TRUE(same("another order, moving", place("box", {0.1f * float(seed), 0, 0})));
  }
  for (const graph::Poison poison : {graph::Poison::Frame, graph::Poison::Handover}) {
    renderer->executor().options.poison = poison;
    ASSERT_TRUE(same("poisoned", place("box", {0, poison == graph::Poison::Frame ? 0.1f : 0.2f, 0})));
    ASSERT_TRUE(same("poisoned, still"));
  }
  renderer->executor().options.layouts = graph::LayoutPolicy::General;
  ASSERT_TRUE(same("general layouts"));
  ASSERT_TRUE(same("general layouts", place("lamp", {0, 2, 0})));
}

TEST_F(ShadowCache, AMeanIsTheSame) {
  std::vector<std::byte> means[2];
  for (int cache = 0; cache < 2; ++cache) {
    Request request;
    request.size = {64, 36};
    request.camera = view.camera;
    request.settings = settings;
    request.settings.shadow.cache = uint32_t(cache);
    request.frames = 4;
    request.accumulate = true;
    request.scan = false;
    means[cache] = shoot(scene, request).picture;
  }
  EXPECT_EQ(means[0], means[1]);
}

// The control: told that its maps already show what they should, the renderer does not draw them.
TEST_F(ShadowCache, AMapThatIsNotDrawnAnewIsSeen) {
  settings.material.blend = 1;
  ASSERT_TRUE(same("first"));
  const auto control = [&](const char* what, const scene::Changes& changes) {
    renderer->update(changes);
    plain->update(changes);
    // What the marks will be, from a graph that never runs.
    settings.shadow.cache = 1;
    graph::Graph graph(renderer->executor().histories());
    renderer->build(graph, view, settings);
    const auto told = renderer->executor().histories();
    std::vector<graph::HistoryState> lies(told.begin(), told.end());
    int maps = 0;
    for (graph::HistoryState& state : lies)
      for (const graph::ResourceRow& row : graph.resources)
        if (row.lifetime == graph::Lifetime::Kept && state.name == row.name) {
          state.marks.assign(graph.marks.begin() + row.first_mark,
                             graph.marks.begin() + row.first_mark + row.desc.layers);
          ++maps;
        }
    EXPECT_EQ(maps, 2);
    const Frame wrong = render(*renderer, true, lies), right = render(*plain, false, plain->executor().histories());
    EXPECT_EQ(wrong.shadow_passes.count("shadow.sun_opaque"), 0u);
    EXPECT_NE(wrong.direct, right.direct) << what;
    renderer->executor().invalidate_histories();
    ASSERT_TRUE(same("drawn anew"));
  };
  scene.directional[0].direction = glm::normalize(vec3(-0.5f, -1, -0.1f));
  control("the sun", {});
  view.camera = look({2, 1.8f, 4}, {0, 0.6f, 0}, 60);
  control("the camera", {});
  control("a box", place("box", {0.5f, 0, 0.3f}));
}

}  // namespace
}  // namespace nf::test
