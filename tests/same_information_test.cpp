// The marcher through depth buffers whose answer is known: planes, a wall, slabs of known thickness, radii.
#include "reference/same_information.h"

#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <numbers>

#include "core/error.h"

namespace nf::reference {
namespace {

constexpr double pi = std::numbers::pi;
using glm::vec3;

struct Seen {
  float depth = 0;
  vec3 normal{0, 0, 1}, radiance{1};
};

// Buffers of an analytic scene: `see` gets the ray of a pixel, of unit length along the axis, in world space. The
// camera stands at `eye` and looks down -z.
Buffers make_buffers(const scene::Camera& camera, glm::uvec2 size, const std::function<Seen(vec3)>& see) {
  Buffers b{size, {}, {}, {}};
  const float ty = std::tan(camera.vfov / 2), tx = ty * float(size.x) / float(size.y);
  for (uint32_t y = 0; y < size.y; ++y) {
    for (uint32_t x = 0; x < size.x; ++x) {
      const Seen s =
          see({((float(x) + 0.5f) / float(size.x) * 2 - 1) * tx, (1 - (float(y) + 0.5f) / float(size.y) * 2) * ty, -1});
      b.depth.push_back(s.depth);
      b.normal.push_back(s.normal);
      b.radiance.push_back(s.radiance);
    }
  }
  return b;
}

scene::Camera camera_at(vec3 eye, float vfov) {
  scene::Camera c;
  c.position = eye;
  c.vfov = vfov;
  c.near = 0.001f;
  return c;
}

struct Result {
  image::Image gi, visibility, bent;
};
Result march(const Buffers& buffers, const MarchSettings& settings, uint32_t samples) {
  Marcher marcher(buffers, settings);
  marcher.sample(samples);
  const std::vector<image::Layer> layers = marcher.layers();
  return {layers[0].image, layers[1].image, layers[2].image};
}

// Of a surface element at the origin with the normal +y to the rectangle [-half, half] x [0, height] of the plane at z
// = -a.
double factor_to_wall(double a, double left, double right, double height) {
  const auto corner = [&](double b) {
    const double r = std::hypot(a, height);
    return (std::atan(b / a) - a / r * std::atan(b / r)) / (2 * pi);
  };
  return corner(right) - corner(left);
}
// The same to the rectangle [left, right] x [front, back] at the height h above it, facing down: Howell's B-3 by
// corners.
double factor_to_ceiling(double h, double left, double right, double front, double back) {
  const auto corner = [&](double a, double b) {
    const double x = a / h, y = b / h, sx = std::sqrt(1 + x * x), sy = std::sqrt(1 + y * y);
    return (x / sx * std::atan(y / sx) + y / sy * std::atan(x / sy)) / (2 * pi);
  };
  return corner(right, back) - corner(left, back) - corner(right, front) + corner(left, front);
}

// A floor to the horizon hides nothing of itself, however grazing.
TEST(SameInformation, APlaneIsOpen) {
  const scene::Camera camera = camera_at({0, 1, 0}, 1.2f);
  const Buffers buffers = make_buffers(camera, {64, 48}, [](vec3 ray) {
    return ray.y < 0 ? Seen{1 / -ray.y, {0, 1, 0}} : Seen{};
  });
  for (const bool infinite : {false, true}) {
    MarchSettings s;
    s.camera = camera;
    s.radius = 1000;
    s.thickness_mode = infinite ? ThicknessMode::Infinite : ThicknessMode::Constant;
    const Result r = march(buffers, s, 128);
    for (const float open : r.visibility.pixels) EXPECT_GE(open, 0.999f);
    for (const float light : r.gi.pixels) EXPECT_LE(light, 0.001f);
  }
  // And one that is tilted in both directions.
  const vec3 n = glm::normalize(vec3(0.3f, 0.5f, 0.8f));
  const Buffers tilted = make_buffers(camera, {40, 40}, [&](vec3 ray) { return Seen{-3 / glm::dot(n, ray), n}; });
  MarchSettings s;
  s.camera = camera;
  s.thickness_mode = ThicknessMode::Infinite;
  for (const float open : march(tilted, s, 128).visibility.pixels) EXPECT_GE(open, 0.999f);
}

// A wall at the floor's end: of it, what the picture shows. Every ray to there stays in the picture, and no other ray
// meets anything.
TEST(SameInformation, Wall) {
  const float vfov = 1.0f, distance = 3, eye = 1;
  const scene::Camera camera = camera_at({0, eye, 0}, vfov);
  constexpr glm::uvec2 size(61, 45);
  const Buffers buffers = make_buffers(camera, size, [&](vec3 ray) {
    const float floor = ray.y < 0 ? eye / -ray.y : 1e9f;
    return floor < distance ? Seen{floor, {0, 1, 0}, vec3(0)} : Seen{distance, {0, 0, 1}, {1, 2, 4}};
  });
  const double ty = std::tan(double(vfov) / 2), tx = ty * size.x / size.y;
  MarchSettings s;
  s.camera = camera;
  s.radius = 1000;
  struct Case {
    bool infinite, uniform;
  };
  for (const Case c : {Case{true, false}, Case{false, false}, Case{true, true}}) {
    s.thickness_mode = c.infinite ? ThicknessMode::Infinite : ThicknessMode::Constant;
    s.thickness = 0.3f;
    s.uniform = c.uniform;
    const Result r = march(buffers, s, 512);
    for (const uint32_t y : {38u, 41u, 43u}) {
      const double tangent = (1 - (y + 0.5) / size.y * 2) * ty, z = eye / -tangent;
      ASSERT_LT(z, double(distance));
      double visibility = 0, red = 0, blue = 0;
      for (uint32_t x = 20; x <= 40; ++x) {
        // The wall reaches further on one side of a point beside the axis.
        const double at = ((x + 0.5) / size.x * 2 - 1) * tx * z;
        const double factor =
            factor_to_wall(distance - z, -tx * distance - at, tx * distance - at, eye + ty * distance);
        visibility += (double(r.visibility.at(x, y, 0)) - (1 - factor)) / 21;
        red += (double(r.gi.at(x, y, 0)) - factor) / 21;
        blue += (double(r.gi.at(x, y, 2)) - 4 * factor) / 21;
        EXPECT_GT(r.bent.at(x, y, 2), 0.0f);  // leans away from the wall
      }
      // The wall's lower edge is half a texel off at most.
      EXPECT_NEAR(visibility, 0, 4e-3) << y << c.infinite << c.uniform;
      EXPECT_NEAR(red, 0, 4e-3) << y << c.infinite << c.uniform;
      EXPECT_NEAR(blue, 0, 16e-3) << y << c.infinite << c.uniform;
    }
  }
}

// From afar, so that columns are upright: a bar, 1 wide and from edge to edge of the picture, floating at the height
// `top` over a ground that faces the camera. It is as thick as we say, so its underside and its side hide a share that
// two form factors give.
TEST(SameInformation, SlabOfKnownThickness) {
  constexpr float far = 2000, top = 0.5f;
  constexpr uint32_t side = 32;
  constexpr double extent = 4;  // of the picture, metres on the ground
  const scene::Camera camera = camera_at({0, 0, far}, 2 * float(std::atan(extent / 2 / double(far))));
  const Buffers buffers = make_buffers(camera, {side, side}, [&](vec3 ray) {
    return std::abs(ray.x) * far < 0.5f ? Seen{far - top, {0, 0, 1}} : Seen{far, {0, 0, 1}};
  });
  MarchSettings s;
  s.camera = camera;
  s.radius = 100;
  s.one_sided = false;
  for (const double thickness : {0.05, 0.2, 0.5, 9.0}) {
    s.thickness = float(thickness);
    const Result r = march(buffers, s, 512);
    for (const uint32_t x : {20u, 22u, 26u}) {
      double visibility = 0, light = 0;
      for (uint32_t y = 0; y < side; ++y) {
        const double px = (x + 0.5) / side * extent - extent / 2, py = extent / 2 - (y + 0.5) / side * extent;
        const double a = px - 0.5, left = -extent / 2 - py, right = extent / 2 - py;
        const double low = std::max(double(top) - thickness, 0.0);
        double hidden = factor_to_wall(a, left, right, double(top));
        if (low > 0) hidden += factor_to_ceiling(low, left, right, a, a + 1) - factor_to_wall(a, left, right, low);
        visibility += (double(r.visibility.at(x, y, 0)) - (1 - hidden)) / side;
        light += (double(r.gi.at(x, y, 0)) - hidden) / side;
      }
      EXPECT_NEAR(visibility, 0, 2e-3) << thickness << " " << x;
      EXPECT_NEAR(light, 0, 2e-3) << thickness << " " << x;
    }
  }
}

// Thickness that grows with the distance is, at one distance, a constant one.
TEST(SameInformation, LinearThickness) {
  constexpr float far = 2000;
  const scene::Camera camera = camera_at({0, 0, far}, 2 * float(std::atan(2 / double(far))));
  const Buffers buffers = make_buffers(camera, {24, 24}, [&](vec3 ray) {
    return std::abs(ray.x) * far < 0.5f ? Seen{far - 1, {0, 0, 1}} : Seen{far, {0, 0, 1}};
  });
  MarchSettings s;
  s.camera = camera;
  s.thickness = 0.4f;
  const Result constant = march(buffers, s, 64);
  s.thickness_mode = ThicknessMode::Linear;
  s.thickness = 0.4f / far;
  const Result linear = march(buffers, s, 64);
  for (size_t i = 0; i < linear.visibility.pixels.size(); ++i)
    EXPECT_NEAR(linear.visibility.pixels[i], constant.visibility.pixels[i], 1 / 63.0f);
  s.thickness = 0.4f;  // 800 m
  EXPECT_NE(march(buffers, s, 64).visibility.pixels, constant.visibility.pixels);
}

// What comes through the open directions, as a Lambert surface reflects it.
TEST(SameInformation, Ambient) {
  const scene::Camera camera = camera_at({0, 1, 0}, 1.2f);
  Buffers buffers = make_buffers(camera, {32, 24}, [](vec3 ray) {
    return ray.y < -0.1f ? Seen{1 / -ray.y, {0, 1, 0}} : ray.x > 0 ? Seen{3} : Seen{};
  });
  scene::Environment sky;
  sky.color = {1, 2, 4};
  MarchSettings s;
  s.camera = camera;
  s.radius = 1000;
  s.environment = &sky;
  EXPECT_EQ(Marcher(buffers, s).layers().size(), 3u);  // albedo is not known
  buffers.albedo.assign(buffers.depth.size(), {0.5f, 0.25f, 1});
  Marcher constant(buffers, s);
  constant.sample(64);
  ASSERT_EQ(constant.layers().size(), 4u);
  const image::Image visibility = constant.layers()[1].image, ambient = constant.layers()[3].image;
  for (size_t i = 0; i < visibility.pixels.size(); ++i) {
    if (buffers.depth[i] == 0) continue;
    EXPECT_NEAR(ambient.pixels[i * 3], 0.5f * visibility.pixels[i], 1e-5f);
    EXPECT_NEAR(ambient.pixels[i * 3 + 1], 0.5f * visibility.pixels[i], 1e-5f);
    EXPECT_NEAR(ambient.pixels[i * 3 + 2], 4 * visibility.pixels[i], 1e-5f);
  }
  // Black at the horizon, 1 - (1 - y)^4 above: over the cosine 1 - 2 B(2, 5) = 14 / 15.
  sky.kind = scene::EnvironmentKind::Gradient;
  sky.zenith = vec3(1);
  Buffers floor = make_buffers(camera, {32, 24}, [](vec3 ray) {
    return ray.y < 0 ? Seen{1 / -ray.y, {0, 1, 0}} : Seen{};
  });
  floor.albedo.assign(floor.depth.size(), vec3(1));
  Marcher gradient(floor, s);
  gradient.sample(256);
  EXPECT_NEAR(gradient.layers()[3].image.at(16, 20, 0), 14 / 15.0, 2e-3);
}

// A bar hides nothing beyond the radius, by each of the three rules.
TEST(SameInformation, Radius) {
  constexpr float far = 2000;
  constexpr double height = 27 / 16.0;  // of the picture in metres, at 16 texels a metre
  const scene::Camera camera = camera_at({0, 0, far}, 2 * float(std::atan(height / 2 / double(far))));
  const Buffers buffers = make_buffers(camera, {40, 27}, [&](vec3 ray) {
    return std::abs(ray.x) * far < 0.5f ? Seen{far - 1, {0, 0, 1}} : Seen{far, {0, 0, 1}};
  });
  MarchSettings s;
  s.camera = camera;
  s.thickness_mode = ThicknessMode::Infinite;
  s.one_sided = false;
  // Pixel 35 is at x = 0.96875, so 0.46875 from the block; its radius of 0.7 m stays in the picture.
  const auto open = [&](RadiusMode mode, float radius) {
    s.radius_mode = mode;
    s.radius = radius;
    const Result r = march(buffers, s, 512);
    double sum = 0;
    for (uint32_t y = 11; y <= 15; ++y) sum += double(r.visibility.at(35, y, 0)) / 5;
    return sum;
  };
  const double a = 0.46875;
  for (const RadiusMode mode : {RadiusMode::Ball, RadiusMode::BallFalloff, RadiusMode::Disc})
    EXPECT_EQ(open(mode, 0.99f * float(a)), 1);
  // Beyond it, by quadrature over the directions: the block is hit at height h where the ray is a / sin(theta) cos(phi)
  // long.
  const auto expected = [&](const std::function<double(double, double)>& weight) {
    double sum = 0;
    constexpr int steps = 600;
    for (int i = 0; i < steps; ++i) {
      for (int j = 0; j < steps; ++j) {
        const double z = std::sqrt((i + 0.5) / steps), phi = 2 * pi * (j + 0.5) / steps, r = std::sqrt(1 - z * z);
        const double along = -r * std::cos(phi);  // towards the block
        const double t = along > 0 ? a / along : 1e30;
        if (t * z < 1) sum += weight(t, t * r);
      }
    }
    return 1 - sum / (double(steps) * steps);
  };
  EXPECT_NEAR(open(RadiusMode::Ball, 0.7f), expected([](double t, double) { return t < 0.7; }), 5e-3);
  EXPECT_NEAR(open(RadiusMode::Disc, 0.7f), expected([](double, double r) { return r < 0.7; }), 5e-3);
  s.falloff = 0.5f;
  EXPECT_NEAR(open(RadiusMode::BallFalloff, 0.7f),
              expected([](double t, double) { return std::clamp((0.7 - t) / 0.35, 0.0, 1.0); }), 5e-3);
}

// Where everything shines with 1 and every stop gives light, light and openness are all there is.
TEST(SameInformation, Complement) {
  const scene::Camera camera = camera_at({0, 0, 0}, 1);
  const Buffers buffers = make_buffers(camera, {48, 32}, [](vec3 ray) {
    return Seen{2 + std::sin(9 * ray.x) * std::cos(7 * ray.y), glm::normalize(-ray)};
  });
  MarchSettings s;
  s.camera = camera;
  s.one_sided = false;
  const Result both = march(buffers, s, 64);
  for (size_t i = 0; i < both.visibility.pixels.size(); ++i)
    EXPECT_NEAR(both.visibility.pixels[i] + both.gi.pixels[i * 3], 1, 1e-5f);
  s.one_sided = true;
  const Result front = march(buffers, s, 64);
  EXPECT_EQ(front.visibility.pixels, both.visibility.pixels);
  double less = 0;
  for (size_t i = 0; i < both.gi.pixels.size(); ++i) {
    EXPECT_LE(front.gi.pixels[i], both.gi.pixels[i]);
    less += double(both.gi.pixels[i] - front.gi.pixels[i]);
  }
  EXPECT_GT(less, 0);
}

TEST(SameInformation, BytesDoNotDependOnThreadsOrRounds) {
  const scene::Camera camera = camera_at({0, 0, 0}, 1);
  const Buffers buffers = make_buffers(camera, {33, 17}, [](vec3 ray) {
    return Seen{2 + std::sin(9 * ray.x), glm::normalize(-ray)};
  });
  MarchSettings s;
  s.camera = camera;
  s.threads = 1;
  Marcher one(buffers, s);
  one.sample(8);
  s.threads = 4;
  Marcher many(buffers, s);
  many.sample(2);
  many.sample(6);
  EXPECT_EQ(one.layers()[0].image.pixels, many.layers()[0].image.pixels);
  EXPECT_EQ(one.noise().size(), 3u);
}

TEST(SameInformation, BuffersNeedTheirLayers) {
  const image::Image one{1, 1, 1, {1}}, three{1, 1, 3, {0, 0, 1}};
  EXPECT_NO_THROW(buffers_from({{"depth", "V", one}, {"normal", "XYZ", three}, {"radiance", "RGB", three}}));
  EXPECT_THROW(buffers_from({{"depth", "V", one}, {"normal", "XYZ", three}}), Error);
}

}  // namespace
}  // namespace nf::reference
