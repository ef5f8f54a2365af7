// Blended surfaces in the path tracer: seen through, over the final radiance, and dimming light by their alpha.
#include "reference_bed.h"

namespace nf::test {
namespace {

constexpr float pi = 3.14159265358979f;

// A floor of side 2 under a pane of side 40 at this height, both seen from above.
struct Covered {
  explicit Covered(float alpha, float height = 1) {
    Builder b;
    const MaterialId white = b.material({.base_color = vec3(0.8f)}), pane = b.material({.base_color = vec3(0.5f)});
    b.quad({-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}, white);
    b.quad({-20, height, 20}, {20, height, 20}, {20, height, -20}, {-20, height, -20}, pane);
    scene = scene_of(b.glb());
    scene.materials[1].alpha = scene::AlphaMode::Blend;
    scene.materials[1].base_color.w = alpha;
    scene.environment.color = vec3(0);
    settings = lambert_settings(down_on_unit_square());
    settings.bounces = 1;
  }
  scene::Scene scene;
  reference::Settings settings;
};

TEST(ReferenceBlend, LayersShowWhatIsBehindAndLightIsDimmed) {
  Covered c(0.25f);
  c.scene.directional.push_back({.direction = {0, -1, 0}, .irradiance = pi});
  const Traced t = trace(c.scene, c.settings, "direct,albedo,depth", 2);
  EXPECT_NEAR(t.mean("albedo"), 0.8, 1e-6);
  EXPECT_NEAR(t.mean("depth"), 4, 1e-5);
  EXPECT_NEAR(t.mean("direct"), 0.8 * 0.75, 1e-5);
  // The pane, lit fully, over that; without bounces.
  c.settings.bounces = 0;
  EXPECT_NEAR(trace(c.scene, c.settings, "", 2).mean(""), 0.25 * 0.5 + 0.75 * 0.8 * 0.75, 1e-5);
}

TEST(ReferenceBlend, TwoWallsLetTheProductThrough) {
  Covered c(0.3f);
  Builder b;
  const MaterialId white = b.material({.base_color = vec3(1)}), pane = b.material({});
  b.quad({-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}, white);
  b.box({0, 1.5f, 0}, {10, 0.5f, 10}, 0, pane);
  c.scene = scene_of(b.glb());
  c.scene.materials[1].alpha = scene::AlphaMode::Blend;
  c.scene.materials[1].base_color.w = 0.3f;
  c.scene.directional.push_back({.direction = glm::normalize(vec3(0.1f, -1, 0)), .irradiance = pi});
  const double cosine = 1 / std::sqrt(1.01);
  EXPECT_NEAR(trace(c.scene, c.settings, "direct", 2).mean("direct"), 0.49 * cosine, 1e-5);
}

TEST(ReferenceBlend, OtherRaysMeetItAsOftenAsItsAlphaSays) {
  Covered c(0.4f, 0.1f);
  c.scene.environment.color = vec3(1);
  const Traced t = trace(c.scene, c.settings, "visibility,ambient", 256);
  std::printf("under a pane of alpha 0.4: visibility %.4f, ambient %.4f (0.6, 0.48)\n", t.mean("visibility"),
              t.mean("ambient"));
  EXPECT_NEAR(t.mean("visibility"), 0.6, 0.01);
  EXPECT_NEAR(t.mean("ambient"), 0.6 * 0.8, 0.01);
}

TEST(ReferenceBlend, AsACutOutItIsThereOrNot) {
  for (const float alpha : {0.45f, 0.55f}) {
    Covered c(alpha);
    c.scene.directional.push_back({.direction = {0, -1, 0}, .irradiance = pi});
    c.settings.blending = reference::Blending::CutOut;
    const Traced t = trace(c.scene, c.settings, "direct,depth", 2);
    EXPECT_NEAR(t.mean("depth"), alpha > 0.5f ? 3 : 4, 1e-5);
    EXPECT_NEAR(t.mean("direct"), alpha > 0.5f ? 0.5 : 0.8, 1e-5);
  }
}

TEST(ReferenceBlend, ThreadsLeaveNoTrace) {
  Covered c(0.4f);
  c.scene.environment.color = vec3(1);
  c.settings.threads = 1;
  const Traced one = trace(c.scene, c.settings, "visibility", 8);
  c.settings.threads = 3;
  const Traced three = trace(c.scene, c.settings, "visibility", 8);
  EXPECT_EQ(one["visibility"].pixels, three["visibility"].pixels);
  EXPECT_EQ(one[""].pixels, three[""].pixels);
}

}  // namespace
}  // namespace nf::test
