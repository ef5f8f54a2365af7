// Sequences of frames of one technique in one place, and what is measured of them.
#include "cli/evaluate_temporal.h"

#include <algorithm>
#include <cmath>
#include <fmt/ranges.h>
#include <glm/gtc/matrix_transform.hpp>
#include <map>
#include <optional>

#include "cli/scene_input.h"
#include "image/temporal.h"
#include "scene/update.h"
#include "scene/view.h"

namespace nf::editor {
namespace {

using nlohmann::json;

struct Interrupted {};

const passes::Aov& signal_of(bool light, bool raw) {
  return passes::find_aov(!light ? "visibility" : raw ? "gi_raw" : "gi");
}

json number(double value) {
  return std::isfinite(value) ? json(value) : json(nullptr);
}

bool is_power_of_two(uint32_t n) {
  return (n & (n - 1)) == 0;
}

// The node of the first of these names that the scene has.
std::optional<uint32_t> find_occluder(const scene::Scene& scene, const std::string& names) {
  for (const std::string& name : split_list(names))
    for (uint32_t node = 0; node < scene.nodes.size(); ++node)
      if (scene.nodes.name[node] == name) return node;
  return std::nullopt;
}

}  // namespace

// Frames of one technique after the other.
class Sequence {
 public:
  Sequence(gpu::Device& device, const EvaluateOptions& options, const TemporalLengths& lengths, const Place& place,
           Notice notice)
      : o_(options), lengths_(lengths), scene_(open_scene(place.scene, options)), notice_(std::move(notice)) {
    view_.size = parse_size(o_.size);
    view_.camera = view_.previous_camera = scene::select_view(place.view, scene_);
    renderer_ = std::make_unique<passes::Renderer>(device, scene_, executor_options(options));
  }

  void take(const passes::FrameSettings& settings) {
    settings_ = settings;
    wants_taa_ = settings.taa.enabled != 0;
    light_ = std::string_view(settings.technique->outputs).find("gi") != std::string_view::npos;
  }
  bool has_light() const { return light_; }

  json convergence() {
    const int asked = settings_.gi.shared.noise;
    json out = {{"frames", lengths_.convergence}, {"seeds", lengths_.seeds}};
    out["own_noise"] = cumulative_means();
    settings_.gi.shared.noise = stbn;
    out["stbn"] = asked == stbn ? out["own_noise"] : cumulative_means();
    settings_.gi.shared.noise = asked;
    return out;
  }

  // How far the median pixel is from a mean of many frames, frame by frame from no history on. Of surfaces alone: the
  // sky has no noise.
  json settling() {
    const RawMean& raw = raw_mean();
    const uint32_t looked_at = std::min(longest_settling, lengths_.own_mean / 2);
    begin(true, o_.seed);
    std::vector<Frame> frames;
    image::RunningMean signal, picture;
    for (uint32_t n = 0; n < lengths_.own_mean; ++n) {
      Frame frame = next("settling");
      if (n < looked_at) {
        frames.push_back(std::move(frame));
      } else {
        signal.add(frame.signal);
        picture.add(frame.radiance);
      }
    }
    std::vector<image::Image> signals, pictures;
    for (Frame& frame : frames) {
      signals.push_back(std::move(frame.signal));
      pictures.push_back(std::move(frame.radiance));
    }
    const auto near = [&](const std::vector<image::Image>& of, const image::Image& to) {
      return until_near(of, to, raw.mask);
    };
    const double mean = image::mean_luminance(raw.signal, raw.mask);
    return {{"own_mean", lengths_.own_mean},
            {"raw", near(raw.first, raw.signal)},
            {"reconstructed", near(signals, signal.mean())},
            {"reconstructed_to_raw", near(signals, raw.signal)},
            {"picture", near(pictures, picture.mean())},
            {"picture_to_raw", near(pictures, raw.picture)},
            {"mean", number(mean)},
            {"reconstructed_bias", number(image::mean_luminance(signal.mean(), raw.mask) / mean - 1)}};
  }

  // An occluder that has stood long is gone from one frame to the next.
  json jump(const std::string& names) {
    const std::optional<uint32_t> node = find_occluder(scene_, names);
    if (!node) return {{"absent", fmt::format("the scene has no node '{}': see --occluder", names)}};
    Jump seen{.with = raw_mean().signal, .without = {}};
    begin(true, o_.seed);
    for (uint32_t n = 0; n < lengths_.before_jump; ++n) {
      Frame frame = next("jump");
      seen.depth_with = std::move(frame.depth);
      if (n + 8 >= lengths_.before_jump) seen.standing.push_back(std::move(frame.signal));
    }
    // Too small to be seen, where it was: the scene's bounds and the shadow maps stay as they are.
    const glm::vec3 scale = scene_.nodes.scale[*node];
    resize(*node, scale * 1e-4f);
    for (uint32_t n = 0; n < lengths_.after_jump; ++n) {
      Frame frame = next("jump");
      seen.depth_without = std::move(frame.depth);
      seen.frames.push_back(std::move(frame.signal));
      renderer_->update(scene::update(scene_));  // it does not move any more
    }
    image::RunningMean without;
    begin(false, o_.seed);
    for (uint32_t n = 0; n < std::min(lengths_.own_mean, longest_without); ++n) without.add(next("jump").signal);
    seen.without = without.mean();
    resize(*node, scale);
    renderer_->update(scene::update(scene_));
    json out = jump_row(seen);
    out["occluder"] = scene_.nodes.name[*node];
    return out;
  }

  // The camera turns by a tenth of a pixel a frame: what of the picture changes other than by drifting.
  json pan() {
    const scene::Camera home = view_.camera;
    begin(true, o_.seed, true);
    const float turn = lengths_.pan_pixels * 2 * std::tan(home.vfov * 0.5f) / float(view_.size.y);
    std::vector<image::Image> signal, picture;
    for (uint32_t n = 0; n < lengths_.pan_warmup + lengths_.pan; ++n) {
      const glm::mat3 turned(glm::rotate(glm::mat4(1), -turn * float(n), home.up));
      view_.camera.forward = turned * home.forward;
      Frame frame = next("pan");
      if (n < lengths_.pan_warmup) continue;
      signal.push_back(std::move(frame.signal));
      picture.push_back(std::move(frame.shown));
    }
    view_.camera = view_.previous_camera = home;
    return {{"signal", number(image::flicker(signal))}, {"picture", number(image::flicker(picture))}};
  }

 private:
  static constexpr int stbn = 4;  // of gi.noise
  static constexpr uint32_t longest_settling = 128, longest_without = 512;

  // One frame: the signal, radiance before the tone curve, depth, and the picture as shown, 0 to 255.
  struct Frame {
    image::Image signal, radiance, depth, shown;
  };
  // Of many frames that nothing reconstructs: means, the signal's means over the first n, and where surfaces are.
  struct RawMean {
    std::string key;
    image::Image signal, picture;
    std::vector<image::Image> first;
    std::vector<uint8_t> mask;
  };

  // Antialiasing comes behind the signal, which its jitter moves about: only who looks at the picture has it.
  void begin(bool reconstruct, uint32_t seed, bool antialias = false) {
    settings_.reconstruct = reconstruct;
    settings_.taa.enabled = antialias && wants_taa_;
    view_.seed = seed;
    view_.previous_camera = view_.camera;
    frame_ = 0;
  }

  Frame next(const char* part) {
    if (interrupted()) throw Interrupted{};
    if (frame_ % 32 == 0) notice_(fmt::format("{}, frame {}", part, frame_));
    const passes::Aov* layers[] = {&signal_of(light_, !settings_.reconstruct), &passes::find_aov(""),
                                   &passes::find_aov("depth")};
    view_.frame_index = frame_;
    run_frame(*renderer_, view_, settings_, {.layers = layers, .picture = true, .forget = frame_ == 0});
    ++frame_;
    const std::vector<graph::Readback> readbacks = renderer_->executor().take_readbacks();
    const auto layer = [&](size_t i) { return to_layer(*layers[i], readbacks[i]).image; };
    const image::Image8 shown = to_image8(readbacks.back());
    return {layer(0),
            layer(1),
            layer(2),
            {shown.width, shown.height, shown.channels, {shown.pixels.begin(), shown.pixels.end()}}};
  }

  // Kept while only stages differ that raw frames do not have.
  const RawMean& raw_mean() {
    std::string key = settings_.technique->id;
    const json params = params::to_json(settings_.blocks());
    for (const auto& [id, value] : params.items())
      if (!id.starts_with("temporal.") && !id.starts_with("denoise.") && !id.starts_with("taa."))
        key += fmt::format(" {}={}", id, value.dump());
    if (raw_.key == key) return raw_;
    raw_ = {};
    begin(false, o_.seed);
    image::RunningMean signal, picture;
    for (uint32_t n = 0; n < lengths_.own_mean; ++n) {
      const Frame frame = next("own mean");
      signal.add(frame.signal);
      picture.add(frame.radiance);
      if (n < longest_settling) raw_.first.push_back(signal.mean());
      if (!n)
        for (const float depth : frame.depth.pixels) raw_.mask.push_back(depth > 0);
    }
    raw_.signal = signal.mean();
    raw_.picture = picture.mean();
    raw_.key = key;
    return raw_;
  }

  // The spread of means with seeds of their own, so that no reference's noise and no bias is in it. A seed turns the
  // pattern of all pixels alike: two that happen to lie close give nearly the same frames, so it takes several.
  json cumulative_means() {
    const uint32_t seeds = lengths_.seeds;
    std::map<uint32_t, std::vector<image::Image>> means;  // by the number of frames
    for (uint32_t seed = o_.seed * seeds; seed < (o_.seed + 1) * seeds; ++seed) {
      begin(false, seed);
      image::RunningMean mean;
      for (uint32_t n = 1; n <= lengths_.convergence; ++n) {
        mean.add(next("convergence").signal);
        if (is_power_of_two(n)) means[n].push_back(mean.mean());
      }
    }
    std::vector<std::pair<double, double>> points;
    for (const auto& [n, pictures] : means) points.emplace_back(n, image::spread(pictures));
    const double scale = image::mean_luminance(means.rbegin()->second.back());
    json rmse = json::array();
    for (const auto& [n, value] : points) rmse.push_back({{"frames", n}, {"rmse", number(value / scale)}});
    return {{"slope", number(image::log_log_slope(points))}, {"rmse", rmse}};
  }

  static json until_near(const std::vector<image::Image>& frames, const image::Image& to,
                         std::span<const uint8_t> mask) {
    json errors = json::array(), found = nullptr;
    for (uint32_t n = 1; n <= frames.size(); ++n) {
      const double error = image::median_relative_error(frames[n - 1], to, mask);
      if (found.is_null() && error <= 0.02) found = n;
      if (is_power_of_two(n) || n == frames.size()) errors.push_back({{"frames", n}, {"median", number(error)}});
    }
    return {{"frames", found}, {"looked_at", frames.size()}, {"errors", errors}};
  }

  void resize(uint32_t node, glm::vec3 scale) {
    scene::Nodes& nodes = scene_.nodes;
    scene::set_local(nodes, node, nodes.translation[node], nodes.rotation[node], scale);
    renderer_->update(scene::update(scene_));
  }

  // Reconstructed frames just before and after the jump, and means of raw frames with the occluder and without it.
  struct Jump {
    image::Image with, without, depth_with, depth_without;
    std::vector<image::Image> standing, frames;
  };

  static json jump_row(const Jump& seen) {
    const double least = 0.1 * image::mean_luminance(seen.without);
    const uint32_t channels = seen.with.channels;
    std::vector<uint8_t> changes(seen.depth_with.pixels.size()), uncovered(changes.size());
    for (size_t i = 0; i < changes.size(); ++i) {
      const float was = seen.depth_with.pixels[i], is = seen.depth_without.pixels[i];
      if (is <= 0) continue;
      const bool stays = std::abs(was - is) <= 0.01f * is;
      double difference = 0;
      for (size_t c = i * channels; c < (i + 1) * channels; ++c)
        difference = std::max(difference, double(std::abs(seen.with.pixels[c] - seen.without.pixels[c])));
      changes[i] = stays && difference > least;
      uncovered[i] = !stays && was < is;
    }
    const auto count = [](const std::vector<uint8_t>& mask) { return std::count(mask.begin(), mask.end(), 1); };
    json out = {{"ghost_pixels", count(changes)}, {"uncovered_pixels", count(uncovered)}};
    if (count(changes) >= 20) {
      // Between what the reconstruction shows of the change while the occluder stands and when all has settled.
      const auto share = [&](const image::Image& frame) {
        return image::share_left(frame, seen.with, seen.without, changes);
      };
      const auto mean_share = [&](auto first, auto last) {
        double sum = 0;
        for (auto frame = first; frame != last; ++frame) sum += share(*frame);
        return sum / double(last - first);
      };
      const double standing = mean_share(seen.standing.begin(), seen.standing.end()),
                   settled = mean_share(seen.frames.end() - ptrdiff_t(seen.frames.size() / 3), seen.frames.end());
      out["shown_of_change"] = number(standing - settled);
      std::vector<double> response;
      for (const image::Image& frame : seen.frames) response.push_back((share(frame) - settled) / (standing - settled));
      if (standing - settled > 0.25) out["half_life"] = number(image::half_life(response));
      response.resize(std::min<size_t>(response.size(), 16));
      out["share_left"] = response;
    }
    if (count(uncovered) >= 20) {
      const double mean = image::mean_luminance(seen.without, uncovered);
      json errors = json::array();
      for (const uint32_t n : {1u, 2u, 4u, 8u, 16u, uint32_t(seen.frames.size())})
        if (n <= seen.frames.size())
          errors.push_back(
              {{"frames", n},
               {"rmse", number(image::rms_difference(seen.frames[n - 1], seen.without, uncovered) / mean)}});
      out["uncovered"] = errors;
    }
    return out;
  }

  const EvaluateOptions& o_;
  const TemporalLengths& lengths_;
  scene::Scene scene_;
  passes::FrameView view_;
  passes::FrameSettings settings_;
  std::unique_ptr<passes::Renderer> renderer_;
  RawMean raw_;
  Notice notice_;
  bool light_ = false, wants_taa_ = true;
  uint32_t frame_ = 0;
};

std::vector<std::string> temporal_parts(const std::string& list) {
  static const std::vector<std::string> known = {"convergence", "settling", "jump", "pan"};
  if (list == "all") return known;
  const std::vector<std::string> wanted = split_list(list);
  for (const std::string& part : wanted)
    if (std::find(known.begin(), known.end(), part) == known.end())
      fail(Exit::Usage, "--temporal={}: there is no part '{}'; leave the list away for all, or write some of {}", list,
           part, fmt::join(known, ","));
  if (wanted.empty()) fail(Exit::Usage, "--temporal: the list is empty; write some of {}", fmt::join(known, ","));
  return wanted;
}

TemporalLengths temporal_lengths(const EvaluateOptions& options) {
  return {.own_mean = options.frames};
}

TemporalStage::TemporalStage(gpu::Device& device, const EvaluateOptions& options, const TemporalLengths& lengths,
                             const Place& place, Notice notice)
    : options_(options),
      place_(place),
      sequence_(std::make_unique<Sequence>(device, options, lengths, place, std::move(notice))) {}
TemporalStage::~TemporalStage() = default;

json TemporalStage::measure(const Contender& contender) {
  const Place& place = place_;
  json row = {{"place", place.label},
              {"scene", place.scene},
              {"view", place.view},
              {"contender", contender.label},
              {"technique", contender.technique},
              {"mode", contender.mode},
              {"preset", contender.preset}};
  passes::FrameSettings all = contender.settings;
  row["params"] = params::to_json(all.blocks());
  if (!*contender.settings.technique->outputs) {
    row["absent"] = "the technique gives nothing";
    return row;
  }
  try {
    Sequence& sequence = *sequence_;
    sequence.take(contender.settings);
    row["signal"] = sequence.has_light() ? "gi" : "visibility";
    const std::vector<std::string> parts = temporal_parts(options_.temporal);
    const auto wanted = [&](const char* part) { return std::find(parts.begin(), parts.end(), part) != parts.end(); };
    if (wanted("convergence")) row["convergence"] = sequence.convergence();
    if (wanted("settling")) row["settling"] = sequence.settling();
    if (wanted("jump")) row["jump"] = sequence.jump(options_.occluder);
    if (wanted("pan")) row["pan"] = sequence.pan();
  } catch (const Interrupted&) {
    return nullptr;
  }
  return row;
}

}  // namespace nf::editor
