// `nearfield compare`: how far a picture is from a reference, in numbers and pictures, with limits for scripts.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "cli/options.h"
#include "cli/picture_input.h"
#include "core/log.h"
#include "image/error_split.h"
#include "image/file.h"

namespace nf::editor {
namespace {

using nlohmann::json;

struct CompareOptions : CommonOptions {
  std::string test, reference, layer, reference_layer, mask, mask_layer, heatmap, diff, json_file;
  std::string same, same_layer, split;  // of the error: what has the same information
  std::string metric = "all", flip = "auto", heat_metric;
  uint32_t block = 1;
  float range = 0;
  std::map<std::string, std::optional<double>> limits;  // by metric id
  std::optional<double> max_abs, max_fail_fraction;
};

std::vector<const image::MetricInfo*> parse_metrics(const std::string& list) {
  std::vector<const image::MetricInfo*> wanted;
  if (list == "all") {
    for (const image::MetricInfo& row : image::metrics()) wanted.push_back(&row);
    return wanted;
  }
  for (const std::string& id : split_list(list)) {
    const image::MetricInfo* info = image::find_metric(id);
    if (!info) {
      std::string known;
      for (const image::MetricInfo& row : image::metrics()) known += fmt::format(" {}", row.id);
      fail(Exit::Usage, "--metric: no metric '{}'; there are{}, or all", id, known);
    }
    if (std::find(wanted.begin(), wanted.end(), info) == wanted.end()) wanted.push_back(info);
  }
  if (wanted.empty()) fail(Exit::Usage, "--metric: the list is empty; write ids, or all");
  return wanted;
}

struct Check {
  std::string name;
  double value = 0, limit = 0;
  bool passed = false;
};

// JSON has no infinity; null would hide which way it went.
json number(double value) {
  if (std::isfinite(value)) return value;
  return std::isnan(value) ? "nan" : value > 0 ? "inf" : "-inf";
}

class CompareJob {
 public:
  explicit CompareJob(const CompareOptions& options) : o_(options) {}

  int run() {
    wanted_ = parse_metrics(o_.metric);
    for (const auto& [id, limit] : o_.limits) {
      const image::MetricInfo* info = image::find_metric(id);
      if (limit && std::find(wanted_.begin(), wanted_.end(), info) == wanted_.end()) wanted_.push_back(info);
    }
    if (o_.max_fail_fraction && !o_.max_abs)
      fail(Exit::Usage, "--max-fail-fraction needs --max-abs: the limit a pixel fails at");
    if (o_.same.empty() && !(o_.split.empty() && o_.same_layer.empty()))
      fail(Exit::Usage,
           "--split and --same-layer need --same-information: what a perfect estimator makes of the screen");
    load();
    for (const image::MetricInfo* info : wanted_) measured_[info->id] = image::measure(info->metric, pair_, hdr_);
    check();
    pictures();
    report();
    const auto failed = std::find_if(checks_.begin(), checks_.end(), [](const Check& c) { return !c.passed; });
    if (failed == checks_.end()) return int(Exit::Ok);
    fail(Exit::CheckFailed, "{} is {:.6g}, the limit is {:.6g}: '{}' is too far from '{}'", failed->name, failed->value,
         failed->limit, o_.test, o_.reference);
  }

 private:
  void load() {
    PictureInput test = read_picture(o_.test, o_.layer);
    // A file of one layer under another name is what other programs write.
    PictureInput reference = o_.reference_layer.empty() ? read_picture(o_.reference, o_.layer, true)
                                                        : read_picture(o_.reference, o_.reference_layer);
    layer_ = test.layer;
    hdr_ = o_.flip == "auto" ? test.linear || reference.linear : o_.flip == "hdr";
    image::Image mask;
    if (!o_.mask.empty()) mask = read_picture(o_.mask, o_.mask_layer, true).image;
    if (!o_.same.empty()) {
      PictureInput same =
          o_.same_layer.empty() ? read_picture(o_.same, o_.layer, true) : read_picture(o_.same, o_.same_layer);
      same_ = image::block_means(image::make_pair(test.image, std::move(same.image), mask), o_.block).reference;
    }
    pair_ = image::block_means(image::make_pair(std::move(test.image), std::move(reference.image), mask), o_.block);
    counted_ = 0;
    for (size_t i = 0; i < size_t(pair_.test.width) * pair_.test.height; ++i) counted_ += pair_.counts(i);
    if (counted_ == 0) fail(Exit::Input, "the mask '{}' leaves no pixel; pixels above 0.5 count", o_.mask);
  }

  void check() {
    for (const image::MetricInfo* info : wanted_) {
      const auto limit = o_.limits.find(info->id);
      if (limit == o_.limits.end() || !limit->second) continue;
      const double value = measured_[info->id].value;
      checks_.push_back(
          {info->id, value, *limit->second, info->more_is_better ? value >= *limit->second : value <= *limit->second});
    }
    if (!o_.max_abs) return;
    if (o_.max_fail_fraction) {
      const double share = image::fraction_above(pair_, *o_.max_abs);
      checks_.push_back({fmt::format("share of pixels above {:.6g}", *o_.max_abs), share, *o_.max_fail_fraction,
                         share <= *o_.max_fail_fraction});
    } else {
      double worst = 0;
      for (size_t i = 0; i < pair_.test.pixels.size(); ++i) {
        if (!pair_.counts(i / pair_.test.channels)) continue;
        const float t = pair_.test.pixels[i], r = pair_.reference.pixels[i];
        const double difference = t == r ? 0 : std::abs(double(t) - double(r));
        worst = std::isnan(difference) ? std::numeric_limits<double>::infinity() : std::max(worst, difference);
      }
      checks_.push_back({"largest difference", worst, *o_.max_abs, worst <= *o_.max_abs});
    }
  }

  void pictures() {
    if (!o_.heatmap.empty()) {
      std::string id = o_.heat_metric;
      if (id.empty()) id = measured_.count("flip") ? "flip" : wanted_.front()->id;
      if (!measured_.count(id)) measured_[id] = image::measure(image::find_metric(id)->metric, pair_, hdr_);
      const image::Measured& m = measured_[id];
      float range = o_.range > 0 ? o_.range : id == "flip" || id == "ssim" ? 1.0f : float(m.pooled.p95);
      if (!(range > 0 && std::isfinite(range))) range = 1;
      image::write_png(o_.heatmap, image::heat_picture(m.map, pair_.mask, range));
      written_.push_back(o_.heatmap);
    }
    if (!o_.diff.empty()) {
      const image::Pooled p = image::pool(image::absolute_error(pair_), pair_.mask);
      float range = o_.range > 0 ? o_.range : float(p.p95);
      if (!(range > 0 && std::isfinite(range))) range = 1;
      image::write_png(o_.diff, image::signed_picture(pair_, range));
      written_.push_back(o_.diff);
    }
    if (!o_.split.empty()) {
      image::write_png(o_.split, image::split_picture(pair_.test, same_, pair_.reference, pair_.mask, o_.range));
      written_.push_back(o_.split);
    }
  }

  // Three pictures without halves: their noise counts as error.
  image::ErrorSplit split() const {
    return image::split_error({pair_.test, pair_.test}, {same_, same_}, {pair_.reference, pair_.reference}, pair_.mask);
  }

  json document() const {
    json values = json::object();
    for (const image::MetricInfo* info : wanted_) {
      const image::Measured& m = measured_.at(info->id);
      values[info->id] = {{"value", number(m.value)},
                          {"map",
                           {{"mean", number(m.pooled.mean)},
                            {"p50", number(m.pooled.p50)},
                            {"p95", number(m.pooled.p95)},
                            {"max", number(m.pooled.max)},
                            {"worst", {m.pooled.worst_x * o_.block, m.pooled.worst_y * o_.block}}}}};
    }
    json checks = json::array();
    bool passed = true;
    for (const Check& c : checks_) {
      checks.push_back({{"name", c.name}, {"value", number(c.value)}, {"limit", c.limit}, {"passed", c.passed}});
      passed &= c.passed;
    }
    json parts = nullptr;
    if (same_.width > 0) {
      const image::ErrorSplit s = split();
      const auto part = [](const image::ErrorPart& p) -> json {
        return {{"bias", number(p.bias)}, {"rmse", number(p.rmse)}};
      };
      parts = {{"total", part(s.total)}, {"estimator", part(s.estimator)}, {"missing", part(s.missing)}};
    }
    const image::Bias b = image::bias(pair_);
    return {{"schema", "nearfield.compare/1"},
            {"version", version_line()},
            {"command", command_line()},
            {"test", o_.test},
            {"reference", o_.reference},
            {"layer", layer_},
            {"size", {pair_.test.width, pair_.test.height}},
            {"block", o_.block},
            {"pixels", counted_},
            {"flip_kind", hdr_ ? "hdr" : "ldr"},
            {"bias", number(b.difference)},
            {"reference_mean", number(b.reference)},
            {"metrics", values},
            {"split", parts},
            {"checks", checks},
            {"passed", passed},
            {"written", written_}};
  }

  void report() {
    if (!o_.json_file.empty()) {
      const std::string text = document().dump(1) + "\n";
      if (o_.json_file == "-") {
        fmt::print("{}", text);
        return;
      }
      image::write_file(o_.json_file, text);
      written_.push_back(o_.json_file);
    }
    if (o_.quiet) return;
    const image::Bias b = image::bias(pair_);
    const std::string unit = o_.block > 1 ? fmt::format("blocks of {0}x{0}", o_.block) : "pixels";
    fmt::print("{}x{}, {} {}{}; mean of the reference {:.6g}, test - reference {:+.6g}\n", pair_.test.width,
               pair_.test.height, counted_, unit, layer_.empty() ? "" : fmt::format(", layer {}", layer_), b.reference,
               b.difference);
    fmt::print("  {:8} {:>12}   by pixel: {:>11} {:>11} {:>11}  worst at\n", "metric", "value", "p50", "p95", "max");
    for (const image::MetricInfo* info : wanted_) {
      const image::Measured& m = measured_.at(info->id);
      fmt::print("  {:8} {:12.6g}             {:11.5g} {:11.5g} {:11.5g}  {},{}\n", info->id, m.value, m.pooled.p50,
                 m.pooled.p95, m.pooled.max, m.pooled.worst_x * o_.block, m.pooled.worst_y * o_.block);
    }
    if (same_.width > 0) {
      const image::ErrorSplit s = split();
      fmt::print("  total = estimator + missing:  bias        rmse\n");
      for (const auto& [name, part] : {std::pair("total", s.total), {"estimator", s.estimator}, {"missing", s.missing}})
        fmt::print("  {:24} {:+10.5g}  {:10.5g}\n", name, part.bias, part.rmse);
    }
    for (const Check& c : checks_)
      fmt::print("  {} {}: {:.6g}, limit {:.6g}\n", c.passed ? "ok  " : "FAIL", c.name, c.value, c.limit);
    for (const std::string& name : written_) fmt::print("{}\n", name);
  }

  const CompareOptions& o_;
  std::vector<const image::MetricInfo*> wanted_;
  image::Pair pair_;
  image::Image same_;  // empty without --same-information
  std::string layer_;
  bool hdr_ = false;
  uint64_t counted_ = 0;
  std::map<std::string, image::Measured> measured_;
  std::vector<Check> checks_;
  std::vector<std::string> written_;
};

std::string metric_help() {
  std::string text = "What the numbers mean (t test, r reference; means over pixels and channels, linear values):\n";
  for (const image::MetricInfo& row : image::metrics()) text += fmt::format("  {:7} {}\n", row.id, row.help);
  return text +
         "  For noisy pictures of smooth light use --block 8: averages of 8x8 pixels keep the bias and lose the "
         "noise.\n"
         "  For light of unknown brightness use relmse or flip; psnr and ssim take 1 as white.\n"
         "PNG files are decoded from sRGB to linear. EXR and HDR are linear already and get HDR-FLIP, two PNGs "
         "LDR-FLIP.\n"
         "Without a limit the exit code is 0 whatever the numbers are; with limits it is 1 when one is passed.\n"
         "Examples:\n"
         "  nearfield compare gi.exr ref.exr --layer gi --mask mask.exr --block 8\n"
         "  nearfield compare new.png golden.png --max-abs 0.0196 --max-fail-fraction 0.001     # 5/255, one in "
         "thousand\n"
         "  nearfield compare gi.exr ref.exr --metric relmse,flip --max-flip 0.05 --heatmap heat.png --json -\n"
         "  nearfield compare f.exr ref.exr --layer gi_raw --reference-layer gi_1 --same-information same.exr "
         "--same-layer gi "
         "--split parts.png";
}

}  // namespace

Command add_compare(CLI::App& parent) {
  auto state = std::make_shared<CompareOptions>();
  CLI::App* app = parent.add_subcommand("compare", "Measure how far a picture is from a reference; limits for scripts");
  app->add_option("TEST", state->test, "Picture to judge: .exr, .png or .hdr")->required();
  app->add_option("REFERENCE", state->reference, "Picture that is right: .exr, .png or .hdr, of the same size")
      ->required();
  app->add_option("--metric", state->metric, "all, or a list of mae,mse,rmse,relmse,psnr,ssim,flip")
      ->type_name("LIST")
      ->capture_default_str();
  app->add_option("--layer", state->layer, "Layer of the EXR files, e.g. gi; default: the final radiance R,G,B")
      ->type_name("NAME");
  app->add_option("--reference-layer", state->reference_layer, "Layer of REFERENCE where it has another name")
      ->type_name("NAME");
  app->add_option("--mask", state->mask, "Only pixels where this picture's first channel is above 0.5")
      ->type_name("FILE");
  app->add_option("--mask-layer", state->mask_layer, "Layer of the mask")->type_name("NAME");
  app->add_option("--block", state->block, "Average blocks of KxK pixels first, those wholly inside the mask")
      ->type_name("K")
      ->check(CLI::Range(1u, 4096u))
      ->capture_default_str();
  for (const image::MetricInfo& row : image::metrics()) {
    app->add_option(fmt::format("--{}-{}", row.more_is_better ? "min" : "max", row.id), state->limits[row.id],
                    fmt::format("Fail (exit code 1) when {} is {} X", row.id, row.more_is_better ? "below" : "above"))
        ->type_name("X");
  }
  app->add_option("--max-abs", state->max_abs, "Fail when a channel of a pixel is further off than X")
      ->type_name("X")
      ->check(CLI::NonNegativeNumber);
  app->add_option("--max-fail-fraction", state->max_fail_fraction,
                  "Share of pixels that may be further off than --max-abs")
      ->type_name("X")
      ->check(CLI::Range(0.0, 1.0));
  app->add_option("--heatmap", state->heatmap, "Picture of the error by pixel, with a colour bar")
      ->type_name("FILE.png");
  app->add_option("--heatmap-metric", state->heat_metric, "What the heat map shows (default flip where measured)")
      ->check(CLI::IsMember({"mae", "mse", "rmse", "relmse", "psnr", "ssim", "flip"}));
  app->add_option("--diff", state->diff, "Picture of the signed difference: red too bright, blue too dark")
      ->type_name("FILE.png");
  app->add_option(
         "--same-information", state->same,
         "What a perfect estimator makes of the same screen (`reference --same-information`): splits the error "
         "into the technique's own and what the screen does not show")
      ->type_name("FILE");
  app->add_option("--same-layer", state->same_layer, "Layer of that file where it has another name")->type_name("NAME");
  app->add_option("--split", state->split, "Heat maps of total, estimator's and missing error side by side, one scale")
      ->type_name("FILE.png");
  app->add_option("--range", state->range, "Error at the end of the colour scale (default: 1 for flip, else the p95)")
      ->type_name("X")
      ->check(CLI::PositiveNumber);
  app->add_option("--flip", state->flip, "Kind of FLIP; auto takes ldr for two PNGs")
      ->check(CLI::IsMember({"auto", "ldr", "hdr"}))
      ->capture_default_str();
  app->add_option("--json", state->json_file, "Everything as one JSON document; - for stdout")->type_name("FILE");
  add_log_flags(*app, *state);
  app->footer(metric_help());
  return {app, [state] {
            start_log(*state);
            return CompareJob(*state).run();
          }};
}

}  // namespace nf::editor
