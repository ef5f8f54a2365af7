// Rays through columns. Along a ray everything is affine in q = s / z(s), s the distance and z the depth: with z0 at
// the start and k the depth gained a metre, 1/z = (1 - k q) / z0, and the point's tangents are T0 + q (d - k T0). The
// plane of a column's front is affine in the tangents too, so a crossing is found without a step length.
#include "reference/same_information.h"

#include <cmath>

#include "core/error.h"
#include "core/parallel.h"
#include "reference/columns.h"
#include "reference/film.h"
#include "reference/scatter.h"
#include "scene/camera.h"

namespace nf::reference {
namespace {

using glm::dvec2;
using glm::dvec3;

constexpr double endless = std::numeric_limits<double>::infinity();
// Depths are floats, and so are the slopes made of them: nearer than this share of 1/z a ray is on a plane, not behind.
constexpr double rounding = 2e-6;

const image::Layer& find(const std::vector<image::Layer>& layers, const std::string& name, uint32_t channels) {
  for (const image::Layer& layer : layers)
    if (layer.name == name && layer.image.channels == channels) return layer;
  fail(Exit::Input,
       "the buffers lack the layer '{}'; make them with `nearfield render SCENE -o F.exr --aov depth,normal,radiance "
       "--precision float`",
       name);
}

struct Stop {
  bool any = false;
  size_t texel = 0;
  double distance = 0;
};

}  // namespace

Buffers buffers_from(const std::vector<image::Layer>& layers) {
  const image::Image& depth = find(layers, "depth", 1).image;
  const image::Image& normal = find(layers, "normal", 3).image;
  const image::Image& radiance = find(layers, "radiance", 3).image;
  Buffers b;
  b.size = {depth.width, depth.height};
  b.depth = depth.pixels;
  for (size_t i = 0; i < b.depth.size(); ++i) {
    b.normal.emplace_back(normal.pixels[i * 3], normal.pixels[i * 3 + 1], normal.pixels[i * 3 + 2]);
    b.radiance.emplace_back(radiance.pixels[i * 3], radiance.pixels[i * 3 + 1], radiance.pixels[i * 3 + 2]);
  }
  for (const image::Layer& layer : layers)
    if (layer.name == "albedo" && layer.image.channels == 3 && layer.image.pixels.size() == b.depth.size() * 3)
      for (size_t i = 0; i < b.depth.size(); ++i)
        b.albedo.emplace_back(layer.image.pixels[i * 3], layer.image.pixels[i * 3 + 1], layer.image.pixels[i * 3 + 2]);
  return b;
}

std::vector<std::string> march_layers(const Buffers& buffers, const MarchSettings& settings) {
  std::vector<std::string> names = {"gi", "visibility", "bent"};
  if (settings.environment && !buffers.albedo.empty()) names.emplace_back("ambient");
  return names;
}

struct Marcher::State {
  Buffers buffers;
  MarchSettings settings;
  Screen screen;
  std::vector<Column> columns;
  glm::dmat3 view_from_world;
  Film film;

  State(Buffers b, const MarchSettings& s)
      : buffers(std::move(b)),
        settings(s),
        screen(s.camera, buffers.size),
        columns(make_columns(buffers)),
        view_from_world(mat3(scene::view_from_world(s.camera))),
        film(make_film(march_layers(buffers, s), buffers.size, 1)) {}

  // Where the ray is in or behind a column's front, and how far behind, in metres of depth.
  double behind(const Column& c, dvec2 from_center, double w_ray) const {
    const double w_front = std::max(c.w + glm::dot(c.slope, from_center), 1e-9);
    if (w_ray > w_front * (1 - rounding)) return -1;
    return w_ray > 0 ? 1 / w_ray - 1 / w_front : endless;
  }

  Stop march(uint32_t px, uint32_t py, dvec3 d) const {
    const double z0 = 1 / columns[size_t(py) * buffers.size.x + px].w;
    const dvec2 start(double(px) + 0.5, double(py) + 0.5), t0 = screen.tangents(start);
    const double k = -d.z;
    const dvec2 per_q = dvec2(d) - k * t0, velocity = per_q / screen.scale;
    double last = k > 0 ? 1 / k : (k < 0 ? (1 - z0 / double(settings.camera.near)) / k : endless);
    const double radius = double(settings.radius);
    if (std::isfinite(settings.radius)) {
      if (settings.radius_mode == RadiusMode::Disc)
        last = std::min(last, radius / (z0 * glm::length(per_q)));
      else if (z0 + radius * k > 0)
        last = std::min(last, radius / (z0 + radius * k));
    }
    const int step_x = velocity.x > 0 ? 1 : -1, step_y = velocity.y > 0 ? 1 : -1;
    const auto boundary = [&](int cell, int step, double from, double v) {
      return v == 0 ? endless : (double(cell + (step > 0)) - from) / v;
    };
    int x = int(px), y = int(py);
    double q0 = 0;
    bool own = true;
    while (q0 < last) {
      const double qx = boundary(x, step_x, start.x, velocity.x), qy = boundary(y, step_y, start.y, velocity.y);
      const double q1 = std::min({qx, qy, last});
      // The receiver's own texel is the receiver.
      if (!own) {
        const size_t texel = size_t(y) * buffers.size.x + size_t(x);
        const double hit = columns[texel].w > 0 ? enter(columns[texel], x, y, start, velocity, z0, k, q0, q1) : -1;
        if (hit >= 0) return {true, texel, hit * z0 / std::max(1 - k * hit, 1e-12)};
      }
      own = false;
      if (q1 >= last) break;
      (qx < qy ? x : y) += qx < qy ? step_x : step_y;
      if (x < 0 || y < 0 || x >= int(buffers.size.x) || y >= int(buffers.size.y)) break;
      q0 = q1;
    }
    return {};
  }

  // In metres of depth.
  double depth_of_solid(const Column& c, dvec2 tangents) const {
    if (settings.thickness_mode == ThicknessMode::Infinite) return endless;
    const double scale = settings.thickness_mode == ThicknessMode::Linear ? 1 / c.w : 1;
    return scale * double(settings.thickness) / std::sqrt(1 + glm::dot(tangents, tangents));
  }

  // The q in [q0, q1], the ray's part over this texel, at which it is stopped, or -1.
  double enter(const Column& c, int x, int y, dvec2 start, dvec2 velocity, double z0, double k, double q0,
               double q1) const {
    const dvec2 center(double(x) + 0.5, double(y) + 0.5);
    const auto at = [&](double q) { return behind(c, start + q * velocity - center, (1 - k * q) / z0); };
    const double first = at(q0), then = at(q1);
    if (first < 0 && then < 0) return -1;
    const double through = depth_of_solid(c, screen.tangents(center));
    if (first >= 0) {
      if (first <= through) return q0;
      return then <= through ? (then >= 0 ? q1 : crossing(c, center, start, velocity, z0, k)) : -1;
    }
    return crossing(c, center, start, velocity, z0, k);
  }

  // Where the ray's 1/z equals the front's.
  static double crossing(const Column& c, dvec2 center, dvec2 start, dvec2 velocity, double z0, double k) {
    const double at_zero = c.w + glm::dot(c.slope, start - center) - 1 / z0;
    const double rate = glm::dot(c.slope, velocity) + k / z0;
    return rate != 0 ? std::max(-at_zero / rate, 0.0) : 0;
  }

  double openness(double distance) const {
    if (settings.radius_mode != RadiusMode::BallFalloff || !std::isfinite(settings.radius)) return 0;
    const double radius = double(settings.radius), edge = std::max(double(settings.falloff) * radius, 1e-6);
    return 1 - std::clamp((radius - distance) / edge, 0.0, 1.0);
  }

  void sample_pixel(uint32_t x, uint32_t y, uint32_t count) {
    const size_t pixel = size_t(y) * buffers.size.x + x;
    PixelSample sample;
    sample.hit = columns[pixel].w > 0;
    const bool with_ambient = film.slots.size() > 3;
    const mat3 frame = frame_about(glm::normalize(buffers.normal[pixel] + (sample.hit ? vec3(0) : vec3(0, 1, 0))));
    for (int half = 0; half < 2; ++half) {
      const uint64_t key = mix(mix(uint64_t(settings.seed) << 1 | uint64_t(half)) ^ (uint64_t(y) << 32 | x));
      for (uint32_t i = film.samples; i < film.samples + count; ++i) {
        if (sample.hit) {
          Stream stream(settings.sampler, key, i);
          const vec2 u = stream.next2();
          // A uniform direction is worth twice its cosine.
          const vec3 local = settings.uniform ? uniform_direction(u) : cosine_direction(u);
          const float weight = settings.uniform ? 2 * local.z : 1;
          const vec3 direction = frame * local;
          const Stop stop = march(x, y, view_from_world * dvec3(direction));
          const float open = stop.any ? float(openness(stop.distance)) : 1.0f;
          sample.visibility = weight * open;
          sample.bent = direction * (weight * open);
          if (with_ambient)
            sample.ambient =
                buffers.albedo[pixel] * scene::radiance(*settings.environment, direction) * (weight * open);
          sample.gi[0] = vec3(0);
          if (stop.any && (!settings.one_sided || glm::dot(buffers.normal[stop.texel], direction) < 0))
            sample.gi[0] = buffers.radiance[stop.texel] * (weight * (1 - open));
        }
        add_sample(film, sample, film.at(pixel, half));
      }
    }
  }

  static vec3 uniform_direction(vec2 u) {
    const float r = std::sqrt(std::max(0.0f, 1 - u.x * u.x)), phi = 2 * pi * u.y;
    return {r * std::cos(phi), r * std::sin(phi), u.x};
  }
};

Marcher::Marcher(Buffers buffers, const MarchSettings& settings)
    : state_(std::make_unique<State>(std::move(buffers), settings)) {}
Marcher::~Marcher() = default;

void Marcher::sample(uint32_t count) {
  State& state = *state_;
  const uint32_t each = (count + 1) / 2;
  for_rows(state.film.size.y, state.settings.threads, [&](uint32_t y) {
    for (uint32_t x = 0; x < state.film.size.x; ++x) state.sample_pixel(x, y, each);
  });
  state.film.samples += each;
}

uint32_t Marcher::samples() const {
  return state_->film.samples * 2;
}
std::vector<image::Layer> Marcher::layers() const {
  return resolve(state_->film, -1);
}
std::vector<image::Layer> Marcher::half(int which) const {
  return resolve(state_->film, which);
}
std::vector<Noise> Marcher::noise() const {
  return noise_of(state_->film);
}

}  // namespace nf::reference
