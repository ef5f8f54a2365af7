// Environments as data: loading, cleaning and looking up of maps, and the gradient's closed form.
#include "scene/environment.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "core/error.h"
#include "core/log.h"
#include "scene/text.h"

namespace nf::scene {
namespace {

constexpr uint32_t gradient_rows = 1024, most_texels = 16384;
constexpr float half_max = 65504, most_radiance = 1e9f;
constexpr float pi = glm::pi<float>();

glm::vec3 gradient(const Environment& e, float y) {
  const float away = 1 - std::min(std::abs(y), 1.0f);
  return glm::mix(y >= 0 ? e.zenith : e.ground, e.horizon, away * away * away * away);
}

glm::vec3 map_radiance(const Environment& e, glm::vec3 d) {
  const float u = 0.5f + (std::atan2(d.z, d.x) + e.rotation) / (2 * pi);
  const float v = 0.5f + std::asin(glm::clamp(d.y, -1.0f, 1.0f)) / pi;
  const float x = (u - std::floor(u)) * float(e.width) - 0.5f;
  const float y = glm::clamp((1 - v) * float(e.height) - 0.5f, 0.0f, float(e.height - 1));
  const float left = std::floor(x), top = std::floor(y);
  const uint32_t x0 = left < 0 ? e.width - 1 : std::min(uint32_t(left), e.width - 1), x1 = (x0 + 1) % e.width;
  const uint32_t y0 = uint32_t(top), y1 = std::min(y0 + 1, e.height - 1);
  const glm::vec3 *upper = &e.texels[size_t(y0) * e.width], *lower = &e.texels[size_t(y1) * e.width];
  return glm::mix(glm::mix(upper[x0], upper[x1], x - left), glm::mix(lower[x0], lower[x1], x - left), y - top);
}

}  // namespace

glm::vec3 radiance(const Environment& e, glm::vec3 direction) {
  switch (e.kind) {
    case EnvironmentKind::Constant:
      return e.color;
    case EnvironmentKind::Gradient:
      return gradient(e, direction.y);
    case EnvironmentKind::Map:
      return map_radiance(e, direction);
  }
  return {};
}

Environment as_map(const Environment& e) {
  if (e.kind == EnvironmentKind::Map) return e;
  Environment map{.kind = EnvironmentKind::Map, .width = 1, .height = 1};
  if (e.kind == EnvironmentKind::Constant) {
    map.texels = {e.color};
    return map;
  }
  map.height = gradient_rows;
  for (uint32_t row = 0; row < gradient_rows; ++row)
    map.texels.push_back(gradient(e, std::cos(pi * (float(row) + 0.5f) / gradient_rows)));
  return map;
}

Environment make_environment_map(const image::Image& picture, const std::string& file, float intensity,
                                 float rotation_deg) {
  if (picture.channels < 3 || picture.width == 0 || picture.height == 0)
    fail(Exit::Input, "cannot use environment '{}': it has {} channels, red, green and blue are needed", file,
         picture.channels);
  if (picture.width > most_texels || picture.height > most_texels)
    fail(Exit::Input, "cannot use environment '{}': {}x{} is more than {} texels a side; scale it down", file,
         picture.width, picture.height, most_texels);
  if (picture.width != 2 * picture.height)
    log::warn("environment '{}' is {}x{}, not 2:1: it is taken for equirectangular all the same", one_line(file),
              picture.width, picture.height);
  Environment map{.kind = EnvironmentKind::Map,
                  .width = picture.width,
                  .height = picture.height,
                  .intensity = intensity,
                  .rotation = float(glm::radians(std::fmod(double(rotation_deg), 360.0))),
                  .file = file};
  const size_t count = size_t(picture.width) * picture.height;
  map.texels.resize(count);
  uint64_t nan = 0, negative = 0, large = 0;
  for (size_t i = 0; i < count; ++i) {
    bool is_nan = false, is_negative = false, is_large = false;
    for (int c = 0; c < 3; ++c) {
      const float in = picture.pixels[i * picture.channels + size_t(c)];
      float out = in * intensity;
      if (std::isnan(in)) is_nan = true, out = 0;
      if (in < 0) is_negative = true, out = 0;
      if (std::isinf(in) && in > 0) out = half_max * intensity, is_large = true;
      if (out > most_radiance) out = most_radiance, is_large = true;
      map.texels[i][c] = out;
    }
    nan += is_nan, negative += is_negative, large += is_large;
  }
  if (nan + negative + large)
    log::warn("environment '{}': clamped {} texels with NaN, {} negative and {} infinite or too large, of {}",
              one_line(file), nan, negative, large, count);
  return map;
}

Environment load_environment_map(const std::filesystem::path& path, float intensity, float rotation_deg) {
  const std::string file = path.string(), extension = path.extension().string();
  if (extension == ".hdr") return make_environment_map(image::read_hdr(path), file, intensity, rotation_deg);
  if (extension != ".exr")
    fail(Exit::Input, "cannot use environment '{}': the name must end in .hdr or .exr", one_line(file));
  const image::ExrFile exr = image::read_exr(path);
  // The default layer comes first where there is one.
  if (exr.layers.empty() || (!exr.layers[0].name.empty() && exr.layers.size() > 1) ||
      !exr.layers[0].channels.starts_with("RGB"))
    fail(Exit::Input, "cannot use environment '{}': it has no layer with the channels R, G and B of its own",
         one_line(file));
  return make_environment_map(exr.layers[0].image, file, intensity, rotation_deg);
}

}  // namespace nf::scene
