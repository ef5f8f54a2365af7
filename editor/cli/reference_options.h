// The flags of `nearfield reference`, and what they mean to the tracer and the marcher.
#pragma once

#include <optional>
#include <string>

#include "cli/options.h"
#include "reference/same_information.h"

namespace nf::editor {

struct ReferenceOptions : CommonOptions {
  std::string scene, output, json_file, precision = "float", radius, radius_mode, pixel = "center", buffers;
  std::string aov = "direct,direct_diffuse,indirect,gi,ambient,visibility,albedo,normal,depth";
  std::string sampler = "sobol", emitters = "both", sky = "both", directions = "cosine";
  uint32_t bounces = 4, threads = 0;
  std::optional<uint32_t> spp;
  std::optional<double> seconds, until_error;
  std::optional<float> falloff;
  bool resume = false, halves = false, include_ambient = false, same_information = false, any_emitter = false,
       bound_gi = false, gpu = false;
};

constexpr uint32_t default_spp = 64, most_spp = 1u << 24;

void add_reference_flags(CLI::App& app, ReferenceOptions& options);
// The text below the flags in --help.
std::string reference_help();

// The material.* parameters as the tracer has them.
void apply_materials(const passes::MaterialParams& material, reference::Settings& settings);
// Without the camera. Throws nf::Error (Exit::Usage).
reference::Settings tracer_settings(const ReferenceOptions& options, const passes::MaterialParams& material);
// What a technique with its parameters takes the screen for.
reference::MarchSettings march_settings(const passes::FrameSettings& frame, const scene::Camera& camera);
// What of them is no property of the data, and what is taken instead; empty when there is nothing.
std::string march_note(const passes::FrameSettings& frame);
// The same settings, unless given.
reference::MarchSettings march_settings(const ReferenceOptions& options, const passes::FrameSettings& frame,
                                        const scene::Camera& camera);

}  // namespace nf::editor
