// The marcher on the device against the one on the CPU: the same answers to their noise, for every meaning of radius
// and thickness; and a changed model is told from it.
#include <cmath>

#include "gpu_fixture.h"
#include "marcher.h"

namespace nf::test {
namespace {

using glm::vec3;
using reference::MarchSettings;
using reference::RadiusMode;
using reference::ThicknessMode;

class GpuMarcherTest : public GpuTest {
 protected:
  static constexpr glm::uvec2 size{48, 31};
  scene::Environment sky_;

  static scene::Camera eye() {
    scene::Camera c;
    c.position = {1, 2, 3};
    c.forward = glm::normalize(vec3(0.3f, -0.4f, -1));
    c.vfov = 1;
    return c;
  }
  // Waves of depth, with posts standing before them and a piece of sky: fronts, backs, edges, slopes.
  static reference::Buffers landscape() {
    reference::Buffers b{size, {}, {}, {}, {}};
    for (uint32_t y = 0; y < size.y; ++y) {
      for (uint32_t x = 0; x < size.x; ++x) {
        const float u = float(x) / float(size.x), v = float(y) / float(size.y);
        float depth = 3 + std::sin(11 * u) * std::cos(9 * v) - v;
        if (x % 12 < 2 && y > 8) depth = 1.5f;
        if (y < 4) depth = 0;
        b.depth.push_back(depth);
        const vec3 n = glm::normalize(vec3(std::sin(7 * u), 1, std::cos(5 * v)));
        b.normal.push_back(depth > 0 ? n : vec3(0));
        b.radiance.push_back(vec3(u, v, 1 + u * v));
        b.albedo.push_back(vec3(0.5f, u, v));
      }
    }
    return b;
  }
  MarchSettings settings() {
    sky_.kind = scene::EnvironmentKind::Gradient;
    sky_.zenith = {0.2f, 0.5f, 1};
    sky_.horizon = {1, 0.9f, 0.8f};
    sky_.ground = {0.3f, 0.2f, 0.1f};
    MarchSettings s;
    s.camera = eye();
    s.environment = &sky_;
    s.radius = 2;
    return s;
  }

  template <class Marcher>
  static std::vector<image::Layer> run(Marcher&& marcher, std::vector<reference::Noise>& noise) {
    marcher.sample(128);
    noise = marcher.noise();
    return marcher.layers();
  }
  // The largest ratio, over the layers, of the difference's RMSE to what the noise of both explains; and of the mean
  // difference to its own standard error.
  struct Apart {
    double rmse = 0, mean = 0;
  };
  static Apart compare(const MarchSettings& on_cpu, const MarchSettings& on_gpu) {
    std::vector<reference::Noise> cpu_noise, gpu_noise;
    const auto cpu = run(reference::Marcher(landscape(), on_cpu), cpu_noise);
    const auto gpu = run(passes::GpuMarcher(device(), landscape(), on_gpu), gpu_noise);
    Apart most;
    EXPECT_EQ(cpu.size(), gpu.size());
    for (size_t i = 0; i < cpu.size(); ++i) {
      EXPECT_EQ(cpu[i].name, gpu[i].name);
      if (cpu[i].name == "bent") continue;  // of unit length: not a mean
      double squares = 0, sum = 0, expected = 0;
      const double count = double(cpu[i].image.pixels.size());
      for (size_t k = 0; k < cpu[i].image.pixels.size(); ++k) {
        const double d = double(gpu[i].image.pixels[k]) - double(cpu[i].image.pixels[k]);
        squares += d * d, sum += d;
      }
      for (const auto* noise : {&cpu_noise, &gpu_noise})
        for (const reference::Noise& n : *noise)
          if (n.layer == cpu[i].name) expected += n.rmse * n.rmse;
      most.rmse = std::max(most.rmse, std::sqrt(squares / count / expected));
      // Channels go together: a third as many numbers are independent.
      most.mean = std::max(most.mean, std::abs(sum / count) / std::sqrt(expected / (count / cpu[i].image.channels)));
    }
    return most;
  }
};

TEST_F(GpuMarcherTest, AgreesWithTheCpu) {
  const auto agree = [&](const MarchSettings& s, const char* what) {
    const Apart apart = compare(s, s);
    EXPECT_LT(apart.rmse, 1.15) << what;
    EXPECT_GT(apart.rmse, 0.8) << what;  // the noise is two noises, not one
    EXPECT_LT(apart.mean, 4) << what;
  };
  MarchSettings s = settings();
  agree(s, "disc, constant");
  s.radius_mode = RadiusMode::Ball;
  s.thickness = 0.6f;
  agree(s, "ball, constant");
  s.radius_mode = RadiusMode::BallFalloff;
  s.thickness_mode = ThicknessMode::Linear;
  s.thickness = 0.1f;
  agree(s, "ball with falloff, linear");
  s.radius = std::numeric_limits<float>::infinity();
  s.thickness_mode = ThicknessMode::Infinite;
  s.uniform = true;
  s.one_sided = false;
  s.sampler = reference::SamplerKind::Independent;
  agree(s, "endless, infinite, uniform, any emitter, white noise");
}

// The same test sees a model that is a little off.
TEST_F(GpuMarcherTest, TellsAnotherModel) {
  const MarchSettings s = settings();
  const auto differs = [&](const MarchSettings& other, const char* what) {
    const Apart apart = compare(s, other);
    EXPECT_TRUE(apart.rmse > 1.15 || apart.mean > 4) << what << " " << apart.rmse << " " << apart.mean;
  };
  MarchSettings other = s;
  other.thickness = 0.3f;
  differs(other, "thickness");
  other = s;
  other.radius_mode = RadiusMode::Ball;
  differs(other, "radius mode");
  other = s;
  other.thickness_mode = ThicknessMode::Linear;
  differs(other, "thickness mode");
  other = s;
  other.one_sided = false;
  differs(other, "emitters");
}

// A plane hides nothing of itself, however grazing, in single precision too.
TEST_F(GpuMarcherTest, APlaneIsOpen) {
  scene::Camera camera;
  camera.position = {0, 1, 0};
  camera.vfov = 1.2f;
  const glm::uvec2 shape{160, 90};
  reference::Buffers b{shape, {}, {}, {}, {}};
  const float ty = std::tan(camera.vfov / 2);
  for (uint32_t y = 0; y < shape.y; ++y) {
    for (uint32_t x = 0; x < shape.x; ++x) {
      const float down = -(1 - (float(y) + 0.5f) / float(shape.y) * 2) * ty;
      b.depth.push_back(down > 0 ? 1 / down : 0);
      b.normal.push_back({0, 1, 0});
      b.radiance.push_back(vec3(1));
    }
  }
  for (const ThicknessMode mode : {ThicknessMode::Constant, ThicknessMode::Infinite}) {
    MarchSettings s;
    s.camera = camera;
    s.radius = 1000;
    s.thickness_mode = mode;
    passes::GpuMarcher marcher(device(), b, s);
    marcher.sample(16);
    double open = 0;
    const std::vector<image::Layer> layers = marcher.layers();
    for (const float v : layers[1].image.pixels) {
      EXPECT_GE(v, 0.9f);
      open += double(v) / (shape.x * shape.y);
    }
    EXPECT_GE(open, 0.9999);
  }
}

// However the samples are divided, they are the same ones.
TEST_F(GpuMarcherTest, RoundsLeaveNoTrace) {
  const MarchSettings s = settings();
  passes::GpuMarcher one(device(), landscape(), s), many(device(), landscape(), s);
  one.sample(24);
  many.sample(2);
  many.sample(22);
  const std::vector<image::Layer> a = one.layers(), b = many.layers();
  for (size_t i = 0; i < a.size(); ++i)
    for (size_t k = 0; k < a[i].image.pixels.size(); ++k)
      EXPECT_NEAR(a[i].image.pixels[k], b[i].image.pixels[k], 1e-5f);
}

}  // namespace
}  // namespace nf::test
