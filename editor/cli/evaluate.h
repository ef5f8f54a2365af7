// What `nearfield evaluate` measures: cells of a table, techniques x scenes with views, and what is in a cell. Its
// parts: evaluate.cpp (the command), evaluate_plan.cpp (what is to be done), evaluate_truth.cpp (references, kept on
// disk), evaluate_cell.cpp (one measurement), evaluate_figures.cpp and
// evaluate_figure_frames.cpp (the papers' figures), evaluate_report.cpp (JSON, Markdown, HTML); evaluate_temporal.h
// (what happens over time).
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "cli/frames.h"
#include "cli/options.h"
#include "image/error_split.h"
#include "reference/same_information.h"

namespace nf::editor {

struct EvaluateOptions : CommonOptions {
  std::vector<std::string> scenes;
  std::string techniques = "all", presets, resolutions, folder = "evaluation", references, markdown;
  std::string temporal;  // what is measured over time, "all" or a list; empty: errors are
  std::string occluder = "short,card,fountain";
  uint32_t frames = 64, timed = 8, spp = 256, bounces = 6, threads = 0;
  bool resume = false, pictures = true;
};

// A scene with a view of it.
struct Place {
  std::string scene, view, label;
};
// A technique in one form with one set of parameters.
struct Contender {
  std::string label, technique, mode, preset;
  std::string resolution = {};  // that the technique runs at, or none asked for: the settings' one does not count then
  passes::FrameSettings settings = {};
};
// Scenes may be FILE or FILE@VIEW. Throws nf::Error (Exit::Usage, Exit::Input).
std::vector<Place> parse_places(const EvaluateOptions& options);
std::vector<Contender> parse_contenders(EvaluateOptions& options);

// One thing that is measured: a layer of the frame against layers of both references.
struct Quantity {
  const char *id, *title;
  const char* layer;  // of the renderer
  const char* truth;  // of the path tracer
  const char* same;   // of the marcher
  bool of_mean;       // its errors are shown as shares of the reference's mean
  bool with_bounces;  // of --bounces, with feedback that has settled
};
std::span<const Quantity> quantities();

// Says what is being done, for the progress line.
using Notice = std::function<void(const std::string&)>;

// --- references
// Layers of a reference as two independent halves.
using Truth = std::map<std::string, image::Halves>;

class TruthStore {
 public:
  // The device marches where it is more than the CPU.
  TruthStore(std::filesystem::path folder, const EvaluateOptions& options, gpu::Device& device, Notice notice);
  // What `gi`, `visibility` and `ambient` are, with the radius of these settings. nullptr: interrupted.
  const Truth* path_traced(const scene::Scene& scene, const scene::Camera& camera,
                           const passes::FrameSettings& settings);
  // `gi_n`, `gi` of --bounces, and `last`, what the last of them adds.
  const Truth* path_traced_bounces(const scene::Scene& scene, const scene::Camera& camera,
                                   const passes::FrameSettings& settings);
  // What a perfect estimator would make of `buffers`.
  const Truth* same_information(const reference::Buffers& buffers, const reference::MarchSettings& settings);
  // `gi`, were what it finds reflected and gathered again, --bounces in all. No surface reflects more than
  // `albedo_limit`.
  const Truth* same_information_bounces(const reference::Buffers& buffers, const reference::MarchSettings& settings,
                                        float albedo_limit);
  // `direct_diffuse` and `depth`.
  const Truth* direct(const scene::Scene& scene, const scene::Camera& camera, const passes::FrameSettings& settings);
  // Made by this run, taken from disk.
  uint32_t made = 0, found = 0;

 private:
  template <class Make>
  const Truth* get(const std::string& kind, uint64_t key, const Make& make);
  reference::Settings tracer_settings(const scene::Camera& camera, const passes::FrameSettings& settings) const;
  const EvaluateOptions& options_;
  std::filesystem::path folder_;
  gpu::Device& device_;
  Notice notice_;
  std::map<std::filesystem::path, Truth> loaded_;
};

// --- one cell
// A place made ready: the renderer, and what its screen shows.
class Stage {
 public:
  Stage(gpu::Device& device, const EvaluateOptions& options, const Place& place);
  const scene::Scene& scene() const { return scene_; }
  const scene::Camera& camera() const { return view_.camera; }
  // Everything that decides a cell's numbers.
  uint64_t key(const Contender& contender) const;
  // The row of the table; null when interrupted. Pictures go to `folder`.
  nlohmann::json measure(const Contender& contender, TruthStore& store, const std::filesystem::path& folder);
  // What the screen shows; after the first measurement.
  const reference::Buffers& buffers() const { return buffers_; }
  // Called by it with what is compared, the technique and the path tracer, and the pixels that count.
  std::function<void(const Quantity&, const image::Halves& test, const image::Halves& truth,
                     const std::vector<uint8_t>& mask)>
      on_means;

 private:
  // Errors of one quantity; null where there is no such light. `same` and `one`, a single frame, may be missing.
  struct Measurement {
    const Quantity& quantity;
    const image::Halves &test, &path;
    const image::Halves* same = nullptr;
    const image::Image* one = nullptr;
    std::string label;              // of the contender
    std::filesystem::path picture;  // or empty
  };
  nlohmann::json errors(const Measurement& of, const std::vector<uint8_t>& mask) const;
  // The row of a quantity with bounces; null where there is no such light, or when interrupted.
  nlohmann::json measure_bounces(const Contender& contender, const Quantity& q, TruthStore& store,
                                 const reference::MarchSettings& march, const std::vector<uint8_t>& mask,
                                 const std::filesystem::path& picture);
  void look(const passes::FrameSettings& settings);
  std::vector<image::Layer> mean(const passes::FrameSettings& settings, std::span<const passes::Aov* const> layers,
                                 uint32_t seed, uint32_t frames);
  // The same with feedback, counted from where the loop has settled; `gain` is what goes round again then.
  std::vector<image::Layer> settled_mean(const Contender& contender, const passes::Aov& layer, uint32_t seed,
                                         uint32_t frames, double& gain, uint32_t& before);
  PassTimes time(const passes::FrameSettings& settings);
  // Of samples taken at pixels spread over the picture, how many have which effect; null where they are not told.
  nlohmann::json count_samples(const passes::FrameSettings& settings);
  gpu::Device& device_;
  const EvaluateOptions& options_;
  const Place& place_;
  scene::Scene scene_;
  passes::FrameView view_;
  std::unique_ptr<passes::Renderer> renderer_;  // made when first needed
  reference::Buffers buffers_;
  std::string looked_with_;              // parameters, JSON
  std::set<std::string> common_passes_;  // of a frame without a technique
};

// A place for frames in sequence.
class FrameStage {
 public:
  FrameStage(gpu::Device& device, const EvaluateOptions& options, const Place& place);
  // Variance of gi after `frames` frames, as reconstructed, over its squared mean: of a pixel, of means of 4x4. null:
  // interrupted.
  nlohmann::json noise(const passes::FrameSettings& settings, uint32_t frames);
  // The camera jumps here from `by` metres (right, up, back) and `degrees` to the left: shares of the surfaces in view
  // without fed-back light, before and after push-pull; how far the light in the holes and elsewhere is from what the
  // camera would have found here, over its mean.
  nlohmann::json holes(const passes::FrameSettings& settings, const glm::vec3& by, float degrees);
  // Direct diffuse light against the path tracer's, over its mean; how much of what is in shadow there is dark here,
  // and how much of what is not. `seen`, `truth`: both as pictures. null: interrupted.
  nlohmann::json direct(const passes::FrameSettings& settings, TruthStore& store, image::Image& seen,
                        image::Image& truth);

 private:
  // The mean of a layer over frames of the technique itself.
  image::Image mean(const passes::FrameSettings& settings, const char* layer, uint32_t seed, uint32_t frames);
  const EvaluateOptions& options_;
  scene::Scene scene_;
  passes::FrameView view_;
  std::unique_ptr<passes::Renderer> renderer_;
};

// --- the papers' figures
// What a variant gave, and the truth.
struct FigureMeans {
  std::string label;
  image::Halves ambient, gi, true_ambient, true_gi;
  std::vector<uint8_t> mask;
};

// A data file of scenes, variants and what is shown of each; `scenes` is the folder of the bundled ones.
class Figures {
 public:
  // Throws nf::Error (Exit::Input).
  Figures(const std::filesystem::path& file, const std::filesystem::path& scenes);
  size_t cells() const;
  // Strips of pictures go to `pictures`. False when interrupted.
  bool run(gpu::Device& device, const EvaluateOptions& options, TruthStore& store,
           const std::filesystem::path& pictures, const std::function<void(size_t, const std::string&)>& notice);
  nlohmann::json document() const;
  // `pictures`: their folder, as the page names it.
  std::string markdown(const EvaluateOptions& options, const std::string& pictures) const;

 private:
  // What of a row's ambient light follows the environment into the figure's `turned` view. False: interrupted.
  bool add_shading(gpu::Device& device, const EvaluateOptions& options, TruthStore& store, size_t figure,
                   const std::vector<FigureMeans>& means, nlohmann::json& rows);
  // The rows of a figure of frames, as its `kind` says, and what it shows as pictures; null: interrupted.
  nlohmann::json frame_rows(gpu::Device& device, const EvaluateOptions& options, TruthStore& store, size_t figure,
                            std::vector<image::Image>& pictures, const std::function<void(const std::string&)>& notice);
  nlohmann::json spec_, results_ = nlohmann::json::array();
  std::vector<Place> places_;
  std::vector<std::vector<Contender>> contenders_;
  uint32_t frames_ = 0;
};

// --- tables
// `rows` in the order of the table.
nlohmann::json evaluation_json(const EvaluateOptions& options, const std::vector<nlohmann::json>& rows,
                               const gpu::DeviceInfo& device, bool complete);
std::string evaluation_markdown(const nlohmann::json& document);
std::string evaluation_html(const nlohmann::json& document);

}  // namespace nf::editor
