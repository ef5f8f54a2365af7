// References on disk: one EXR file each, named by what decides its content.
#include <algorithm>

#include "cli/evaluate.h"
#include "cli/reference_options.h"
#include "core/fingerprint.h"
#include "image/image.h"
#include "marcher.h"

namespace nf::editor {
namespace {

namespace fs = std::filesystem;

// To be raised by whoever changes what the tracer or the marcher finds.
constexpr uint32_t reference_version = 1;

// Both halves of an estimator's layers, in rounds: `spp` samples, and on to `most` while any layer has more noise than
// 2 % of its mean. False when interrupted.
template <class Estimator>
bool sample(Estimator& estimator, uint32_t spp, uint32_t most, const Notice& notice, const char* what, Truth& truth) {
  const auto noisy = [&] {
    for (const reference::Noise& n : estimator.noise())
      if (n.relative() > 0.02) return true;
    return false;
  };
  for (uint32_t target = spp; estimator.samples() < target;) {
    if (interrupted()) return false;
    estimator.sample(std::min(16u, target - estimator.samples()));
    notice(fmt::format("{}: {} of {} spp", what, estimator.samples(), target));
    if (estimator.samples() >= target && target < most && noisy()) target = std::min(target * 2, most);
  }
  std::vector<image::Layer> a = estimator.half(0), b = estimator.half(1);
  for (size_t i = 0; i < a.size(); ++i) truth[a[i].name] = {std::move(a[i].image), std::move(b[i].image)};
  return true;
}

std::string channels_of(const image::Image& picture) {
  return picture.channels == 1 ? "V" : "RGB";
}

}  // namespace

TruthStore::TruthStore(fs::path folder, const EvaluateOptions& options, gpu::Device& device, Notice notice)
    : options_(options), folder_(std::move(folder)), device_(device), notice_(std::move(notice)) {}

template <class Make>
const Truth* TruthStore::get(const std::string& kind, uint64_t key, const Make& make) {
  const fs::path path = folder_ / fmt::format("{}-{:016x}.exr", kind, key);
  if (const auto known = loaded_.find(path); known != loaded_.end()) return &known->second;
  Truth truth;
  if (fs::exists(path)) {
    for (image::Layer& layer : image::read_exr(path).layers) {
      image::Halves& halves = truth[layer.name.substr(2)];
      (layer.name.starts_with("a.") ? halves.a : halves.b) = std::move(layer.image);
    }
    ++found;
  } else {
    if (!make(truth)) return nullptr;
    std::vector<image::Layer> layers;
    for (const auto& [name, halves] : truth) {
      layers.push_back({"a." + name, channels_of(halves.a), halves.a});
      layers.push_back({"b." + name, channels_of(halves.b), halves.b});
    }
    image::write_exr(path, layers, {{"nearfield.version", version_short()}, {"nearfield.halves", "a, b"}},
                     image::Precision::Float);
    ++made;
  }
  return &loaded_.emplace(path, std::move(truth)).first->second;
}

reference::Settings TruthStore::tracer_settings(const scene::Camera& camera,
                                                const passes::FrameSettings& settings) const {
  const reference::MarchSettings limits = march_settings(settings, camera);
  reference::Settings s;
  s.camera = camera;
  s.size = parse_size(options_.size);
  s.bounces = 1;
  s.radius = limits.radius;
  s.radius_mode = limits.radius_mode;
  s.falloff = limits.falloff;
  s.bound_gi = true;
  apply_materials(settings.material, s);
  s.seed = options_.seed;
  s.threads = options_.threads;
  return s;
}

const Truth* TruthStore::path_traced(const scene::Scene& scene, const scene::Camera& camera,
                                     const passes::FrameSettings& settings) {
  const reference::Settings s = tracer_settings(camera, settings);
  const std::vector<std::string> layers = {"visibility", "gi_1", "ambient", "depth"};
  Fingerprint f;
  f.add(reference_version), f.add(options_.spp), f.add(reference::fingerprint(scene, s, layers));
  return get("path", f.value(), [&](Truth& truth) {
    notice_("path tracing");
    reference::Tracer tracer(scene, s, layers);
    return sample(tracer, options_.spp, options_.spp, notice_, "path tracing", truth);
  });
}

const Truth* TruthStore::path_traced_bounces(const scene::Scene& scene, const scene::Camera& camera,
                                             const passes::FrameSettings& settings) {
  reference::Settings s = tracer_settings(camera, settings);
  s.bounces = options_.bounces;
  s.include_ambient = settings.feedback.include_ambient != 0;
  const std::string all = fmt::format("gi_{}", s.bounces), but_one = fmt::format("gi_{}", s.bounces - 1);
  Fingerprint f;
  f.add(reference_version), f.add(options_.spp), f.add(reference::fingerprint(scene, s, {all, but_one}));
  return get("bounces", f.value(), [&](Truth& truth) {
    notice_("path tracing bounces");
    reference::Tracer tracer(scene, s, {all, but_one});
    if (!sample(tracer, options_.spp, options_.spp, notice_, "path tracing bounces", truth)) return false;
    image::Halves last = truth.at(all);
    const image::Halves& before = truth.at(but_one);
    for (size_t i = 0; i < last.a.pixels.size(); ++i)
      last.a.pixels[i] -= before.a.pixels[i], last.b.pixels[i] -= before.b.pixels[i];
    Truth kept = {{"gi_n", truth.at(all)}, {"last", std::move(last)}};
    truth = std::move(kept);
    return true;
  });
}

const Truth* TruthStore::direct(const scene::Scene& scene, const scene::Camera& camera,
                                const passes::FrameSettings& settings) {
  const reference::Settings s = tracer_settings(camera, settings);
  const std::vector<std::string> layers = {"direct_diffuse", "depth"};
  Fingerprint f;
  f.add(reference_version), f.add(options_.spp), f.add(reference::fingerprint(scene, s, layers));
  return get("direct", f.value(), [&](Truth& truth) {
    reference::Tracer tracer(scene, s, layers);
    return sample(tracer, options_.spp, options_.spp, notice_, "path tracing direct light", truth);
  });
}

namespace {

// Everything that decides what a marcher finds.
void add_march(Fingerprint& f, const reference::Buffers& buffers, const reference::MarchSettings& s) {
  f.add(buffers.size), f.add(buffers.depth), f.add(buffers.normal), f.add(buffers.radiance), f.add(buffers.albedo);
  f.add(s.camera.position), f.add(s.camera.forward), f.add(s.camera.up), f.add(s.camera.vfov), f.add(s.camera.near);
  f.add(s.radius), f.add(s.radius_mode), f.add(s.falloff), f.add(s.thickness), f.add(s.thickness_mode),
      f.add(s.one_sided), f.add(s.uniform), f.add(s.sampler), f.add(s.seed);
  if (const scene::Environment* e = s.environment) {
    f.add(e->kind), f.add(e->color), f.add(e->zenith), f.add(e->horizon), f.add(e->ground), f.add(e->texels),
        f.add(e->rotation);
  }
}

}  // namespace

const Truth* TruthStore::same_information_bounces(const reference::Buffers& buffers,
                                                  const reference::MarchSettings& settings, float albedo_limit) {
  const bool on_gpu = !device_.facts.software;
  Fingerprint f;
  f.add(on_gpu), f.add(reference_version), f.add(options_.spp), f.add(options_.bounces), f.add(albedo_limit);
  add_march(f, buffers, settings);
  return get("same-bounces", f.value(), [&](Truth& truth) {
    // Each half goes its own way: what one feeds back has no noise of the other.
    const auto settle = [&](uint32_t first_seed, image::Image& out) {
      reference::Buffers lit = buffers;
      for (uint32_t n = 0; n < options_.bounces; ++n) {
        if (interrupted()) return false;
        notice_(fmt::format("same information: bounce {} of {}", n + 1, options_.bounces));
        reference::MarchSettings s = settings;
        s.environment = nullptr;
        s.seed = first_seed + n;
        const auto march = [&](auto&& marcher) {
          // What is fed back is averaged over many pixels; the last gathering is what is shown.
          marcher.sample(options_.spp * (n + 1 == options_.bounces ? 8 : 1));
          for (image::Layer& layer : marcher.layers())
            if (layer.name == "gi") out = std::move(layer.image);
        };
        on_gpu ? march(passes::GpuMarcher(device_, lit, s)) : march(reference::Marcher(lit, s));
        for (size_t i = 0; i < lit.radiance.size(); ++i) {
          const glm::vec3 gi(out.pixels[3 * i], out.pixels[3 * i + 1], out.pixels[3 * i + 2]);
          const glm::vec3 albedo = buffers.albedo[i];
          const float most = std::max({albedo.x, albedo.y, albedo.z, albedo_limit});
          lit.radiance[i] = buffers.radiance[i] + albedo * (most > 0 ? albedo_limit / most : 0.0f) * gi;
        }
      }
      return true;
    };
    image::Halves& gi = truth["gi"];
    return settle(settings.seed * 64, gi.a) && settle(settings.seed * 64 + 32, gi.b);
  });
}

const Truth* TruthStore::same_information(const reference::Buffers& buffers, const reference::MarchSettings& s) {
  const bool on_gpu = !device_.facts.software;
  Fingerprint f;
  f.add(on_gpu), f.add(reference_version), f.add(options_.spp * 8);
  add_march(f, buffers, s);
  return get("same", f.value(), [&](Truth& truth) {
    // Marched rays find a lamp only by chance, and are cheap.
    const auto march = [&](auto&& marcher) {
      return sample(marcher, options_.spp, options_.spp * 8, notice_, "same information", truth);
    };
    const bool done = on_gpu ? march(passes::GpuMarcher(device_, buffers, s)) : march(reference::Marcher(buffers, s));
    truth.erase("bent");
    return done;
  });
}

}  // namespace nf::editor
