// Scenes made by a test, traced into layers.
#pragma once

#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <string>
#include <unistd.h>

#include "builder.h"
#include "image/file.h"
#include "reference/reference.h"
#include "scene/gltf.h"

namespace nf::test {

using content::Builder;
using content::MaterialId;
using glm::vec3;

inline scene::Scene scene_of(const std::vector<uint8_t>& glb) {
  static int count = 0;
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / fmt::format("nf_reference_{}_{}.glb", getpid(), count++);
  image::write_file(path, glb);
  scene::Scene scene = scene::load_gltf(path);
  std::filesystem::remove(path);
  return scene;
}

inline scene::Camera camera(vec3 eye, vec3 target, float vfov_deg, vec3 up = {0, 1, 0}) {
  scene::Camera c;
  c.position = eye;
  c.forward = glm::normalize(target - eye);
  c.up = up;
  c.vfov = glm::radians(vfov_deg);
  c.near = 0.01f;
  return c;
}

// Straight down on a square of side 1 in the plane y = 0 about the origin, which fills the picture: equal pixels are
// equal areas of it. What stands between must show its back.
inline scene::Camera down_on_unit_square(float height = 4) {
  return camera({0, height, 0}, {0, 0, 0}, glm::degrees(2 * std::atan(0.5f / height)), {0, 0, -1});
}

inline reference::Settings lambert_settings(const scene::Camera& eye, uint32_t width = 8, uint32_t height = 8) {
  reference::Settings s;
  s.camera = eye;
  s.size = {width, height};
  s.lambert = true;
  return s;
}

struct Traced {
  std::vector<image::Layer> layers;
  std::vector<reference::Noise> noise;
  const image::Image& operator[](const std::string& name) const {
    for (const image::Layer& layer : layers)
      if (layer.name == name) return layer.image;
    ADD_FAILURE() << "no layer " << name;
    static const image::Image none;
    return none;
  }
  // Over all pixels; of one channel.
  double mean(const std::string& name, uint32_t channel = 0) const {
    const image::Image& image = (*this)[name];
    double sum = 0;
    for (size_t i = channel; i < image.pixels.size(); i += image.channels) sum += double(image.pixels[i]);
    return sum * image.channels / double(image.pixels.size());
  }
  double rmse(const std::string& name) const {
    for (const reference::Noise& n : noise)
      if (n.layer == name) return n.rmse;
    return 0;
  }
  // The standard error of `mean`, were the pixels' errors independent.
  double sigma(const std::string& name) const {
    const image::Image& image = (*this)[name];
    return rmse(name) / std::sqrt(double(image.width) * image.height);
  }
};

inline Traced trace(const scene::Scene& scene, const reference::Settings& settings, const std::string& layers,
                    uint32_t samples) {
  reference::Tracer tracer(scene, settings, reference::parse_layers(layers, settings.bounces));
  tracer.sample(samples);
  return {tracer.layers(), tracer.noise()};
}

}  // namespace nf::test
