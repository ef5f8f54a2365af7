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

void apply_materials(const passes::MaterialParams& material, reference::Settings& settings) {
  settings.lambert = material.lambert != 0;
  settings.albedo_scale = material.albedo_scale;
  settings.emissive_scale = material.emissive_scale;
  settings.blending = reference::Blending(material.blend);
}

reference::Settings tracer_settings(const ReferenceOptions& o, const passes::MaterialParams& material) {
  reference::Settings s;
  s.size = parse_size(o.size);
  s.bounces = o.bounces;
  s.radius = parse_radius(o.radius);
  s.radius_mode = parse_radius_mode(o.radius_mode, reference::RadiusMode::Ball);
  s.falloff = o.falloff.value_or(s.falloff);
  s.bound_gi = o.bound_gi;
  apply_materials(material, s);
  s.include_ambient = o.include_ambient;
  s.pixel_box = o.pixel == "box";
  s.sampler = o.sampler == "independent" ? reference::SamplerKind::Independent : reference::SamplerKind::Sobol;
  s.emitters = o.emitters == "directions" ? reference::EmitterSampling::Directions
               : o.emitters == "surfaces" ? reference::EmitterSampling::Surfaces
                                          : reference::EmitterSampling::Both;
  s.sky = o.sky == "directions" ? reference::SkySampling::Directions : reference::SkySampling::Both;
  s.seed = o.seed;
  s.threads = o.threads;
  return s;
}

reference::MarchSettings march_settings(const passes::FrameSettings& frame, const scene::Camera& camera) {
  const passes::GiParams& gi = frame.gi.shared;
  reference::MarchSettings s;
  s.camera = camera;
  s.radius = gi.radius;
  s.radius_mode = gi.radius_mode == 0   ? reference::RadiusMode::Disc
                  : gi.radius_mode == 1 ? reference::RadiusMode::Ball
                                        : reference::RadiusMode::BallFalloff;
  s.falloff = gi.falloff;
  s.thickness = gi.thickness;
  s.thickness_mode = gi.thickness_mode == 1   ? reference::ThicknessMode::Linear
                     : gi.thickness_mode == 3 ? reference::ThicknessMode::Infinite
                                              : reference::ThicknessMode::Constant;
  if (frame.technique->infinitely_thick) s.thickness_mode = reference::ThicknessMode::Infinite;
  if (frame.technique->in_ball) s.radius_mode = reference::RadiusMode::Ball;
  return s;
}

std::string march_note(const passes::FrameSettings& frame) {
  const passes::GiParams& gi = frame.gi.shared;
  if (frame.technique->infinitely_thick) return "";
  std::string note;
  if (gi.thickness_mode == 2)
    note =
        fmt::format("angular thickness depends on the receiver, not on the data: constant {} m is taken", gi.thickness);
  if (gi.back_along == 1)
    note += fmt::format("{}backs along the receiver's view ray are no property of the data: the sample's own is taken",
                        note.empty() ? "" : "; ");
  return note;
}

reference::MarchSettings march_settings(const ReferenceOptions& o, const passes::FrameSettings& frame,
                                        const scene::Camera& camera) {
  reference::MarchSettings s = march_settings(frame, camera);
  if (!o.radius.empty()) s.radius = parse_radius(o.radius);
  s.radius_mode = parse_radius_mode(o.radius_mode, s.radius_mode);
  if (o.falloff) s.falloff = *o.falloff;
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
         "screen, at any depth, as techniques on a depth buffer see them. Default ball, with --same-information "
         "gi.radius_mode")
      ->check(CLI::IsMember({"ball", "ball_falloff", "disc"}));
  app.add_option("--falloff", o.falloff, "Share of the radius over which ball_falloff fades (default 0.615)")
      ->check(CLI::Range(0.0f, 1.0f));
  app.add_flag("--bound-gi", o.bound_gi, "gi, too, gathers only within the radius at each bounce, as techniques do");
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
  app.add_option("--sky", o.sky,
                 "How light of an environment map is found: by directions, or also by its bright texels")
      ->check(CLI::IsMember({"both", "directions"}))
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
  app.add_flag("--gpu", o.gpu, "March on the Vulkan device; the same model in single precision, with other noise");
  app.add_option("--device", o.device, "Which one: INDEX, part of its NAME, cpu or gpu")->envname("NEARFIELD_DEVICE");
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
