// Threads over rows of the picture, and what survives an interruption.
#include <cstring>

#include "core/error.h"
#include "core/fingerprint.h"
#include "core/parallel.h"
#include "image/file.h"
#include "reference/film.h"

namespace nf::reference {
namespace {

constexpr char magic[] = "nearfield.checkpoint/1\n";

}  // namespace

uint64_t fingerprint(const scene::Scene& scene, const Settings& s, const std::vector<std::string>& layers) {
  Fingerprint f;
  f.add(scene.geometry.position);
  f.add(scene.geometry.normal);
  f.add(scene.geometry.uv0);
  f.add(scene.geometry.color);
  f.add(scene.geometry.index);
  f.add(scene.nodes.world);
  f.add(scene.instances.primitive);
  f.add(scene.joints.matrix);
  f.add(scene.morph_weights.value);
  for (const scene::Material& m : scene.materials) {
    f.add(m.base_color), f.add(m.metallic), f.add(m.roughness), f.add(m.emissive), f.add(m.normal_scale);
    f.add(m.alpha_cutoff), f.add(m.alpha), f.add(m.double_sided), f.add(m.unlit);
    f.add(m.ior), f.add(m.specular), f.add(m.specular_color), f.add(m.mapping);
    for (const uint32_t texture : {m.base_color_texture, m.metallic_roughness_texture, m.normal_texture,
                                   m.emissive_texture, m.specular_texture, m.specular_color_texture})
      f.add(texture);
  }
  for (const scene::Texture& t : scene.textures)
    f.add(t.picture), f.add(t.sampler.mag), f.add(t.sampler.u), f.add(t.sampler.v);
  for (const scene::Picture& p : scene.pictures) f.add(p.rgba);
  f.add(scene.directional);
  f.add(scene.punctual);
  const scene::Environment& e = scene.environment;
  f.add(e.kind), f.add(e.color), f.add(e.zenith), f.add(e.horizon), f.add(e.ground);
  f.add(e.width), f.add(e.texels), f.add(e.rotation);
  f.add(s.camera.position), f.add(s.camera.forward), f.add(s.camera.up), f.add(s.camera.vfov), f.add(s.camera.near);
  f.add(s.size), f.add(s.bounces), f.add(s.radius), f.add(s.radius_mode), f.add(s.falloff), f.add(s.bound_gi),
      f.add(s.lambert), f.add(s.blending), f.add(s.albedo_scale), f.add(s.emissive_scale);
  f.add(s.include_ambient), f.add(s.pixel_box), f.add(s.sampler), f.add(s.emitters), f.add(s.sky), f.add(s.seed);
  for (const std::string& layer : layers) f.add(layer);
  return f.value();
}

struct Tracer::State {
  State(const scene::Scene& scene, const Settings& s, const std::vector<std::string>& names)
      : settings(s),
        layers(names),
        world(scene, s),
        rays(world, s.cancel),
        lights(world),
        film(make_film(names, s.size, s.bounces)) {}

  Settings settings;
  std::vector<std::string> layers;
  World world;
  Rays rays;
  Lights lights;
  Film film;
  uint64_t ray_count = 0;

  bool cancelled() const { return settings.cancel && settings.cancel->load(std::memory_order_relaxed); }

  void sample_pixel(const Integrator& it, uint32_t x, uint32_t y, uint32_t count, uint64_t& rays_here) {
    const size_t pixel = size_t(y) * film.size.x + x;
    const bool steady = !settings.pixel_box;
    const Ray center = camera_ray(settings, vec2(x, y) + 0.5f);
    PixelSample sample;
    if (steady) sample = first_hit(it, center, rays_here);
    for (int half = 0; half < 2; ++half) {
      const uint64_t key = mix(mix(uint64_t(settings.seed) << 1 | uint64_t(half)) ^ (uint64_t(y) << 32 | x));
      double* sums = film.at(pixel, half);
      for (uint32_t i = film.samples; i < film.samples + count; ++i) {
        Stream stream(settings.sampler, key, i);
        Ray ray = center;
        if (!steady) {
          ray = camera_ray(settings, vec2(x, y) + stream.next2());
          sample = first_hit(it, ray, rays_here);
        }
        gather(it, ray, stream, sample, rays_here);
        add_sample(film, sample, sums);
      }
    }
  }
};

Tracer::Tracer(const scene::Scene& scene, const Settings& settings, std::vector<std::string> layers)
    : state_(std::make_unique<State>(scene, settings, layers)) {
  NF_CHECK(settings.bounces <= max_bounces, "{} bounces", settings.bounces);
}

Tracer::~Tracer() = default;

bool Tracer::sample(uint32_t count) {
  State& state = *state_;
  const uint32_t each = (count + 1) / 2;
  const Integrator it{state.world, state.rays, state.lights, state.settings, wanted_by(state.film)};
  std::atomic<uint64_t> rays = 0;
  for_rows(state.film.size.y, state.settings.threads, [&](uint32_t y) {
    uint64_t rays_here = 0;
    for (uint32_t x = 0; x < state.film.size.x && !state.cancelled(); ++x)
      state.sample_pixel(it, x, y, each, rays_here);
    rays += rays_here;
  });
  state.film.samples += each;
  state.ray_count += rays;
  return !state.cancelled();
}

void Tracer::set_view(const scene::Camera& camera, glm::uvec2 size) {
  State& state = *state_;
  state.settings.camera = camera;
  state.settings.size = size;
  state.film = make_film(state.layers, size, state.settings.bounces);
  state.ray_count = 0;
}

uint32_t Tracer::samples() const {
  return state_->film.samples * 2;
}
uint64_t Tracer::rays() const {
  return state_->ray_count;
}
std::vector<image::Layer> Tracer::layers() const {
  return resolve(state_->film, -1);
}
std::vector<image::Layer> Tracer::half(int which) const {
  return resolve(state_->film, which);
}
std::vector<Noise> Tracer::noise() const {
  return noise_of(state_->film);
}

void Tracer::save(const std::filesystem::path& path) const {
  const Film& film = state_->film;
  const uint64_t print = fingerprint(state_->world.scene(), state_->settings, state_->layers);
  std::vector<uint8_t> bytes(magic, magic + sizeof magic - 1);
  const auto append = [&](const void* data, size_t size) {
    const auto* from = static_cast<const uint8_t*>(data);
    bytes.insert(bytes.end(), from, from + size);
  };
  bytes.reserve(bytes.size() + 16 + film.sums.size() * sizeof(double));
  append(&print, sizeof print);
  append(&film.samples, sizeof film.samples);
  append(film.sums.data(), film.sums.size() * sizeof(double));
  image::write_file(path, bytes);
}

void Tracer::load(const std::filesystem::path& path) {
  Film& film = state_->film;
  const std::vector<uint8_t> bytes = image::read_file(path);
  const size_t head = sizeof magic - 1, data = head + sizeof(uint64_t) + sizeof(uint32_t);
  if (bytes.size() < data || std::memcmp(bytes.data(), magic, head) != 0)
    fail(Exit::Input, "cannot resume from '{}': it is no checkpoint of this version; delete it to start anew",
         path.string());
  uint64_t print = 0;
  std::memcpy(&print, bytes.data() + head, sizeof print);
  if (print != fingerprint(state_->world.scene(), state_->settings, state_->layers) ||
      bytes.size() != data + film.sums.size() * sizeof(double))
    fail(Exit::Input,
         "cannot resume from '{}': it was made with another scene, view, size, seed, layers or settings; use the same, "
         "or "
         "delete it to start anew",
         path.string());
  std::memcpy(&film.samples, bytes.data() + data - sizeof film.samples, sizeof film.samples);
  std::memcpy(film.sums.data(), bytes.data() + data, film.sums.size() * sizeof(double));
}

}  // namespace nf::reference
