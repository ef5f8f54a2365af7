// The distance between a scene's peaks against scenes whose peaks are where the test put them.
#include "scene/peaks.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <random>

#include "builder.h"
#include "scene_files.h"

namespace {

using namespace nf;
using namespace nf::scene;
using nf::content::Builder;
using nf::test::Folder;

struct Mesh {
  std::vector<vec3> position;
  std::vector<uint32_t> index;
  float distance() const { return peak_distance(position, index); }
};

// `bumps` x `bumps` of them, each `pitch` wide, `height` high, of cells x cells faces: sin^2 in both directions, so all
// borders are level.
Mesh egg_crate(uint32_t bumps, float pitch, float height, uint32_t cells) {
  Mesh mesh;
  const uint32_t n = bumps * cells;
  const auto wave = [&](uint32_t i) {
    const double s = std::sin(std::numbers::pi * (i % cells) / cells);
    return s * s;
  };
  for (uint32_t y = 0; y <= n; ++y)
    for (uint32_t x = 0; x <= n; ++x)
      mesh.position.emplace_back(pitch * float(x) / float(cells), height * float(wave(x) * wave(y)),
                                 pitch * float(y) / float(cells));
  for (uint32_t y = 0; y < n; ++y)
    for (uint32_t x = 0; x < n; ++x) {
      const uint32_t a = y * (n + 1) + x, b = a + 1, c = a + n + 1, d = c + 1;
      mesh.index.insert(mesh.index.end(), {a, c, b, b, c, d});
    }
  return mesh;
}

TEST(Peaks, BumpsAreAPitchApart) {
  for (const uint32_t cells : {4u, 8u, 14u})
    for (const float height : {0.02f, 0.5f})
      EXPECT_NEAR(egg_crate(5, 0.3f, height, cells).distance(), 0.3f, 1e-5f) << cells << " " << height;
  // The controls: nothing rises; and one bump has no neighbour.
  EXPECT_EQ(egg_crate(5, 0.3f, 0, 8).distance(), 0);
  EXPECT_EQ(egg_crate(1, 0.3f, 0.5f, 8).distance(), 0);
}

Scene posts(float scale, float first_gap, float second_gap) {
  Builder b;
  b.object("posts", {.translation = vec3(3, -2, 7) * scale, .scale = vec3(scale)});
  const auto material = b.material({});
  for (const float x : {0.0f, first_gap, first_gap + second_gap}) b.box({x, 0.5f, 0}, {0.1f, 0.5f, 0.2f}, 0, material);
  const Folder folder;
  return load_gltf(folder.write("posts.glb", b.glb()));
}

// Neighbours: 1 m, 1 m and 3 m away, in every direction.
TEST(Peaks, TheNearestOtherCounts) {
  const float expected = (1.0f + 1.0f + 3.0f) / 3;
  EXPECT_NEAR(peak_distance(posts(1, 1, 3)), expected, 1e-5f);
  for (const float scale : {0.01f, 100.0f})
    EXPECT_NEAR(peak_distance(posts(scale, 1, 3)) / (expected * scale), 1, 1e-4f) << scale;
  EXPECT_NEAR(peak_distance(posts(1, 2, 2)), 2, 1e-5f) << "control";
}

// The walls of a room are level, and there is one of each.
TEST(Peaks, ARoomHasNone) {
  Builder b;
  b.room({0, 1, 0}, vec3(2, 1, 3), b.material({}));
  const Folder folder;
  EXPECT_EQ(peak_distance(load_gltf(folder.write("room.glb", b.glb()))), 0);
}

// Triangles in any order, each with vertices of its own, are the same surface.
TEST(Peaks, OnlyTheSurfaceCounts) {
  const Mesh mesh = egg_crate(4, 1, 0.3f, 6);
  std::vector<uint32_t> order(mesh.index.size() / 3);
  for (uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  std::shuffle(order.begin(), order.end(), std::mt19937(7));
  Mesh soup;
  for (const uint32_t t : order)
    for (uint32_t k = 0; k < 3; ++k) {
      soup.index.push_back(uint32_t(soup.position.size()));
      soup.position.push_back(mesh.position[mesh.index[3 * t + k]]);
    }
  EXPECT_EQ(soup.distance(), mesh.distance());
  EXPECT_EQ(soup.distance(), soup.distance());
  // The control: triangles that do not touch are peaks of their own.
  for (vec3& p : soup.position) p += vec3(0, 0.001f * float((&p - soup.position.data()) / 3), 0);
  EXPECT_LT(soup.distance(), 0.5f * mesh.distance());
}

}  // namespace
