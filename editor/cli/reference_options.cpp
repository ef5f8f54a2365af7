// Flags of `nearfield reference`.
#include "cli/reference_options.h"

#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <limits>

#include "core/error.h"

namespace nf::editor {
namespace {

float parse_radius(const std::string& text) {
  if (text.empty() || text == "inf") return std::numeric_limits<float>::infinity();
  float value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !(value > 0) || !std::isfinite(value))
    fail(Exit::Usage, "bad --radius '{}': give metres above 0, or inf", text);
  return value;
}

reference::RadiusMode parse_radius_mode(const std::string& text, reference::RadiusMode otherwise) {
  if (text.empty()) return otherwise;
  return text == "disc"           ? reference::RadiusMode::Disc
         : text == "ball_falloff" ? reference::RadiusMode::BallFalloff
                                  : reference::RadiusMode::Ball;
}

}  // namespace

reference::Settings tracer_settings(const ReferenceOptions& o, const passes::MaterialParams& material) {
  reference::Settings s;
  s.size = parse_size(o.size);
  s.bounces = o.bounces;
  s.radius = parse_radius(o.radius);
  s.radius_mode = parse_radius_mode(o.radius_mode, reference::RadiusMode::Ball);
  s.falloff = o.falloff;
  s.bound_gi = o.bound_gi;
  s.lambert = material.lambert != 0;
  s.blending = reference::Blending(material.blend);
  s.include_ambient = o.include_ambient;
  s.pixel_box = o.pixel == "box";
  s.sampler = o.sampler == "independent" ? reference::SamplerKind::Independent : reference::SamplerKind::Sobol;
  s.emitters = o.emitters == "directions" ? reference::EmitterSampling::Directions
               : o.emitters == "surfaces" ? reference::EmitterSampling::Surfaces
                                          : reference::EmitterSampling::Both;
  s.seed = o.seed;
  s.threads = o.threads;
  return s;
}

reference::MarchSettings march_settings(const ReferenceOptions& o, const passes::GiParams& gi,
                                        const scene::Camera& camera) {
  reference::MarchSettings s;
  s.camera = camera;
  s.radius = o.radius.empty() ? gi.radius : parse_radius(o.radius);
  s.radius_mode = parse_radius_mode(o.radius_mode, reference::RadiusMode::Disc);
  s.falloff = o.falloff;
  s.thickness = gi.thickness;
  s.infinite_thickness = gi.thickness_mode == 3;  // infinite
  s.one_sided = !o.any_emitter;
  s.uniform = o.directions == "uniform";
  s.sampler = o.sampler == "independent" ? reference::SamplerKind::Independent : reference::SamplerKind::Sobol;
  s.seed = o.seed;
  s.threads = o.threads;
  return s;
}

std::string reference_help() {
  std::string text = "Layers (R,G,B, the final radiance, is always there):\n";
  for (const reference::LayerInfo& info : reference::layer_infos())
    if (*info.name) text += fmt::format("  {:16} {}\n", info.name, info.help);
  return text +
         "  gi_K, indirect_K the same with K bounces\n"
         "Light is counted as `render` counts it, so that layers compare one by one. Ctrl-C finishes the round, writes "
         "what\n"
         "is there and a checkpoint beside it; --resume goes on from there, and keeps the checkpoint for still more "
         "samples.\n"
         "Examples:\n"
         "  nearfield reference scene.glb -o ref.exr --size 640x360 --spp 1024\n"
         "  nearfield reference scene.glb -o ref.exr --until-error 0.01 --resume     # 1 % noise in every layer\n"
         "  nearfield reference scene.glb -o ao.exr --aov visibility --radius 2 --radius-mode disc --seconds 30\n"
         "  nearfield compare frame.exr ref.exr --layer gi --block 8\n"
         "The error of a technique has two parts: its own, against --same-information, and what the screen does not "
         "show,\n"
         "which is that against the path tracer:\n"
         "  nearfield render scene.glb -o f.exr --aov all --precision float --frames 64 --accumulate\n"
         "  nearfield reference scene.glb -o same.exr --same-information --buffers f.exr --spp 256\n"
         "  nearfield compare f.exr same.exr --layer gi_raw --reference-layer gi --block 8";
}

void add_reference_flags(CLI::App& app, ReferenceOptions& o) {
  app.add_option("SCENE", o.scene, "glTF scene (.gltf, .glb)")->required();
  app.add_option("-o,--output", o.output, "Where to write, .exr")->type_name("FILE")->required();
  app.add_option("--aov", o.aov, "Layers: all, or a list")->type_name("LIST")->capture_default_str();
  app.add_option("--spp", o.spp, "Samples a pixel, rounded up to an even number (default 64; powers of two are best)")
      ->type_name("N")
      ->check(CLI::Range(1u, most_spp));
  app.add_option("--seconds", o.seconds, "Stop after this time")->type_name("S")->check(CLI::PositiveNumber);
  app.add_option("--until-error", o.until_error, "Stop when the noise of every layer is below this share of its mean")
      ->type_name("E")
      ->check(CLI::PositiveNumber);
  app.add_option("--bounces", o.bounces, "Bounces of gi and indirect: eye, surface, K more surfaces")
      ->type_name("K")
      ->check(CLI::Range(0u, reference::max_bounces))
      ->capture_default_str();
  app.add_option("--radius", o.radius,
                 "Radius of visibility and bent in metres, or inf (the default); with --same-information of gi too, "
                 "and gi.radius the default")
      ->type_name("R");
  app.add_option(
         "--radius-mode", o.radius_mode,
         "ball: occluders within R of the point; ball_falloff: with a weight that fades; disc: within R of it on the "
         "screen, at any depth, as techniques on a depth buffer see them. Default ball, with --same-information disc")
      ->check(CLI::IsMember({"ball", "ball_falloff", "disc"}));
  app.add_option("--falloff", o.falloff, "Share of the radius over which ball_falloff fades")
      ->check(CLI::Range(0.0f, 1.0f))
      ->capture_default_str();
  app.add_flag("--bound-gi", o.bound_gi, "gi, too, gathers only within the radius, as techniques do");
  app.add_flag("--include-ambient", o.include_ambient, "gi gathers the environment's light at the bounces too");
  app.add_option("--pixel", o.pixel, "center: one point, as the G-buffer has it; box: the mean over the pixel")
      ->check(CLI::IsMember({"center", "box"}))
      ->capture_default_str();
  app.add_option("--sampler", o.sampler, "Random numbers")
      ->check(CLI::IsMember({"sobol", "independent"}))
      ->capture_default_str();
  app.add_option("--emitters", o.emitters,
                 "How emissive surfaces are found: by choosing surfaces, by directions, or both weighed")
      ->check(CLI::IsMember({"both", "directions", "surfaces"}))
      ->capture_default_str();
  app.add_flag("--same-information", o.same_information,
               "Instead march rays through what the techniques see: depth with gi.thickness, normals, radiance");
  app.add_option("--buffers", o.buffers,
                 "Take that from an EXR of `render --aov depth,normal,radiance --precision float` of this view; else "
                 "it is traced here")
      ->type_name("FILE");
  app.add_option("--directions", o.directions, "How the marched rays are spread")
      ->check(CLI::IsMember({"cosine", "uniform"}))
      ->capture_default_str();
  app.add_flag("--any-emitter", o.any_emitter, "Marched rays take light from surfaces turned away, too");
  app.add_flag("--halves", o.halves, "Also write both half-buffers, FILE.a.exr and FILE.b.exr");
  app.add_flag("--resume", o.resume, "Go on from FILE.exr.checkpoint where there is one, and keep it");
  app.add_option("--threads", o.threads, "Threads (0: all); the bytes do not depend on it")
      ->check(CLI::Range(0u, 256u));
  add_picture_flags(app, o);
  app.add_option("--set", o.sets, "Set a parameter; of use here: --set material.lambert=true and material.blend=cutout")
      ->type_name("ID=VALUE")
      ->allow_extra_args(false);
  app.add_option("--precision", o.precision, "EXR channels")
      ->check(CLI::IsMember({"half", "float"}))
      ->capture_default_str();
  app.add_option("--json", o.json_file, "Samples, time, noise and paths as one JSON document; - for stdout")
      ->type_name("FILE");
  add_log_flags(app, o);
}

}  // namespace nf::editor
