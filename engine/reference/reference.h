// A path tracer over the scene tables: the truth that screen-space techniques are held against. It counts light exactly
// as the renderer does (the README's split of light), so that its layers compare one to one with the renderer's.
#pragma once

#include <atomic>
#include <filesystem>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "image/image.h"
#include "scene/scene.h"

namespace nf::reference {

enum class SamplerKind : uint8_t { Sobol, Independent };  // Owen-scrambled, or white noise

// How far an occluder may be. Ball: within `radius` of the point. BallFalloff: its weight falls linearly to nothing
// over the last `falloff` share of the radius. Disc: its picture within `radius` of the point's, in metres at the
// point's depth, however far behind or in front; this is what a march over the depth buffer sees.
enum class RadiusMode : uint8_t { Ball, BallFalloff, Disc };

// Which of the two ways to find emissive surfaces is used; Both weighs them by the balance heuristic (Veach 1997, 9.2).
enum class EmitterSampling : uint8_t { Both, Directions, Surfaces };

// alphaMode BLEND, as material.blend. Over: rays pass or meet such a surface by its alpha; camera rays pass, so that
// the layers are of what is behind, and the final radiance has it over that. CutOut: as MASK, at alpha 0.5.
enum class Blending : uint8_t { Over, CutOut };

// The same of an environment map: Both also chooses bright texels, and weighs.
enum class SkySampling : uint8_t { Both, Directions };

inline constexpr uint32_t max_bounces = 16;

struct Settings {
  scene::Camera camera;
  glm::uvec2 size{320, 180};
  uint32_t bounces = 4;                                   // of `gi`, at most max_bounces
  float radius = std::numeric_limits<float>::infinity();  // of `visibility` and `bent`, metres
  RadiusMode radius_mode = RadiusMode::Ball;
  float falloff = 0.615f;
  bool bound_gi = false;  // gi, too, gathers at each bounce only within the radius, as techniques do
  bool lambert = false;   // as material.lambert
  float albedo_scale = 1, emissive_scale = 1;  // as material.albedo_scale, material.emissive_scale
  Blending blending = Blending::Over;
  bool include_ambient = false;  // as feedback.include_ambient: gi also gathers the environment's light at the bounces
  bool pixel_box = false;        // average over the pixel; else its centre, where the G-buffer has its sample
  SamplerKind sampler = SamplerKind::Sobol;
  EmitterSampling emitters = EmitterSampling::Both;
  SkySampling sky = SkySampling::Both;
  uint32_t seed = 1;
  uint32_t threads = 0;  // 0: all there are. The result does not depend on it.
  // Where it becomes true the tracer gives up at once: its constructor throws Cancelled, sample() returns false.
  const std::atomic<bool>* cancel = nullptr;
};
struct Cancelled {};

// Layers by name: those of the README, `direct_specular`, `specular` (all light over a specular bounce that no other
// layer has), and `gi_K`, `indirect_K`: the same as `gi`, `indirect` with K bounces. "" is the final radiance.
struct LayerInfo {
  const char* name;
  const char* channels;
  const char* help;
};
std::span<const LayerInfo> layer_infos();
// "a,b" or "all" to names, the final radiance first. Throws nf::Error (Exit::Input) for an unknown name.
std::vector<std::string> parse_layers(const std::string& list, uint32_t bounces);

// What the two halves of the samples say about each other. `rmse` is the standard error of the mean picture, over
// pixels and channels; `mean` that of the absolute value.
struct Noise {
  std::string layer;
  double rmse = 0, mean = 0;
  double relative() const { return mean > 0 ? rmse / mean : 0; }
};

// Name and version of what traces the rays.
std::string backend();

// A number of everything that decides what a tracer finds, but for the number of samples.
uint64_t fingerprint(const scene::Scene& scene, const Settings& settings, const std::vector<std::string>& layers);

class Tracer {
 public:
  // Builds the ray structure. The scene must stay as it is while the tracer lives.
  Tracer(const scene::Scene& scene, const Settings& settings, std::vector<std::string> layers);
  ~Tracer();
  Tracer(const Tracer&) = delete;
  Tracer& operator=(const Tracer&) = delete;

  // Takes `count` more samples of every pixel, rounded up to an even number: half of them for each half-buffer, whose
  // sample sequences are independent of each other. False: cancelled, and what the tracer holds means nothing.
  bool sample(uint32_t count);
  // Starts anew with another camera and size. The ray structure stays.
  void set_view(const scene::Camera& camera, glm::uvec2 size);
  uint32_t samples() const;  // of a pixel, both halves
  uint64_t rays() const;     // traced so far, shadow rays included

  std::vector<image::Layer> layers() const;
  std::vector<image::Layer> half(int which) const;  // 0 or 1
  // Of every layer that has noise.
  std::vector<Noise> noise() const;

  // The sums so far. Loading throws nf::Error (Exit::Input) when the file is damaged or belongs to another scene, view
  // or settings; the number of samples then goes on from there, with the same bytes as if never interrupted.
  void save(const std::filesystem::path& path) const;
  void load(const std::filesystem::path& path);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace nf::reference
