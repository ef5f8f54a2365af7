// The bundled scenes.
#include "scenes.h"

#include "builder.h"
#include "textures.h"

namespace nf::content {

std::vector<uint8_t> cornell() {
  Builder b;
  const MaterialId white = b.material({.name = "white", .base_color = vec3(0.73f)});
  const MaterialId red = b.material({.name = "red", .base_color = {0.65f, 0.05f, 0.05f}});
  const MaterialId green = b.material({.name = "green", .base_color = {0.12f, 0.45f, 0.15f}});
  const MaterialId lamp = b.material({.name = "lamp", .base_color = vec3(0.73f), .emissive = vec3(15)});

  b.object("floor");
  b.quad({-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}, white);
  b.object("ceiling");
  b.quad({-1, 2, -1}, {1, 2, -1}, {1, 2, 1}, {-1, 2, 1}, white);
  b.object("back");
  b.quad({-1, 0, -1}, {1, 0, -1}, {1, 2, -1}, {-1, 2, -1}, white);
  b.object("left");
  b.quad({-1, 0, 1}, {-1, 0, -1}, {-1, 2, -1}, {-1, 2, 1}, red);
  b.object("right");
  b.quad({1, 0, -1}, {1, 0, 1}, {1, 2, 1}, {1, 2, -1}, green);
  // Places and angles are those of the measured box (Cornell University, 1998), its 555 mm scaled to 2 m.
  b.object("tall");
  b.box({-0.326f, 0.595f, -0.265f}, {0.298f, 0.595f, 0.298f}, glm::radians(17.2f), white);
  const ObjectId low = b.object("short");
  b.box({0.333f, 0.297f, 0.391f}, {0.3f, 0.297f, 0.3f}, glm::radians(-17.0f), white);
  // Slides towards the front and back, and rises a little on its way.
  b.animate_translation(low, {0, 1, 2, 3, 4},
                        {vec3(0), {-0.15f, 0.1f, 0.1f}, {-0.45f, 0, 0.2f}, {-0.2f, 0.1f, 0.1f}, vec3(0)});
  b.object("lamp");
  b.quad({-0.25f, 1.99f, -0.25f}, {0.25f, 1.99f, -0.25f}, {0.25f, 1.99f, 0.25f}, {-0.25f, 1.99f, 0.25f}, lamp);

  b.camera("front", {0, 1, 3.3f}, {0, 1, 0}, 48);
  b.camera("corner", {0.75f, 1.6f, 0.85f}, {-0.4f, 0.5f, -0.6f}, 60);
  return b.glb();
}

std::vector<uint8_t> fence() {
  Builder b;
  const Bricks bricks = brick_pictures(256);
  const MaterialId ground = b.material({.name = "ground", .base_color = {0.45f, 0.42f, 0.38f}});
  const MaterialId wall = b.material({.name = "wall",
                                      .base_color_picture = b.picture("bricks", bricks.color),
                                      .normal_picture = b.picture("bricks_normal", bricks.normal)});
  const MaterialId iron = b.material({.name = "iron", .base_color = {0.2f, 0.22f, 0.25f}, .roughness = 0.6f});
  const MaterialId leaves = b.material({.name = "leaves",
                                        .alpha_cutoff = 0.5f,
                                        .double_sided = true,
                                        .base_color_picture = b.picture("leaves", leaf_picture(256))});

  b.object("ground");
  b.grid({-3, 0, 4}, {3, 0, 4}, {3, 0, 0}, {-3, 0, 0}, 6, 4, ground);
  b.object("wall");
  b.quad({-3, 0, 0}, {3, 0, 0}, {3, 2.4f, 0}, {-3, 2.4f, 0}, wall, {6, 2.4f});

  constexpr int bars = 24;
  constexpr float spacing = 0.12f, radius = 0.015f, height = 1.2f, before_wall = 0.35f;
  b.object("bars");
  for (int i = 0; i < bars; ++i) {
    const float x = (float(i) - 0.5f * float(bars - 1)) * spacing;
    b.cylinder({x, 0, before_wall}, {x, height, before_wall}, radius, 8, iron);
  }
  b.object("rails");
  for (float y : {0.2f, 1.05f}) {
    b.box({0, y, before_wall - radius - 0.01f}, {0.5f * bars * spacing, 0.02f, 0.01f}, 0, iron);
  }
  const auto turned = [](float degrees) { return glm::angleAxis(glm::radians(degrees), vec3(0, 1, 0)); };
  const ObjectId card = b.object("card", {.translation = {0.95f, 0, 0.75f}, .rotation = turned(-25)});
  b.animate_rotation(card, {0, 1, 2, 3, 4}, {turned(-25), turned(0), turned(-25), turned(-50), turned(-25)});
  b.quad({-0.4f, 0, 0}, {0.4f, 0, 0}, {0.4f, 0.8f, 0}, {-0.4f, 0.8f, 0}, leaves);

  b.directional_light({0.45f, -0.8f, -0.65f}, 3);
  b.camera("front", {0, 0.9f, 2.6f}, {0, 0.65f, 0}, 50);
  b.camera("side", {-1.9f, 0.8f, 0.95f}, {0.4f, 0.55f, 0.2f}, 55);
  return b.glb();
}

std::vector<uint8_t> furnace() {
  Builder b;
  const MaterialId white = b.material({.name = "white", .base_color = vec3(0.8f), .emissive = vec3(1)});
  b.object("room");
  b.room({0, 1, 0}, vec3(1), white);
  b.camera("centre", {0, 1, 0}, {0, 1, -1}, 75);
  b.camera("corner", {0.8f, 1.8f, 0.8f}, {-0.5f, 0.5f, -0.5f}, 60);
  return b.glb();
}

}  // namespace nf::content
