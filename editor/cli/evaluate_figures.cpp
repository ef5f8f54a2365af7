// The papers' figures as numbers: settings from a data file, measured as every other cell, in small tables.
#include <algorithm>
#include <cmath>

#include "cli/evaluate.h"
#include "cli/paper_spec.h"
#include "image/file.h"

namespace nf::editor {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// "visibility.total.rmse" and the like: a quantity, a part, rmse or bias. "gi_1.variance": of one frame, over the
// square of the reference's mean.
std::string shown_value(const json& row, const std::string& what, uint32_t frames) {
  const std::string id = what.substr(0, what.find('.')), rest = what.substr(what.find('.') + 1);
  const json& quantities = row["quantities"];
  if (!quantities.contains(id)) return "–";
  const json& q = quantities[id];
  const double mean = q["reference_mean"];
  if (rest == "variance") {
    const double noise = q["noise"]["technique"];
    return fmt::format("{:.3g}", noise * noise * frames / (mean * mean));
  }
  if (rest == "flip" || rest == "relmse") return fmt::format("{:.4f}", q[rest].get<double>());
  const std::string part = rest.substr(0, rest.find('.')), measure = rest.substr(rest.find('.') + 1);
  if (!q.contains(part)) return "–";
  const bool light = id != "visibility";
  const double value = q[part][measure].get<double>(), floor = q[part]["floor"];
  const bool below = measure == "rmse" && value < floor;
  const double shown = (below ? floor : value) / (light ? 0.01 * mean : 1);
  const std::string text = measure == "bias" ? fmt::format("{:+.{}f}", shown, light ? 1 : 4)
                                             : fmt::format("{}{:.{}f}", below ? "< " : "", shown, light ? 1 : 4);
  return light ? text + " %" : text;
}

// sRGB, side by side with a gap of 4 pixels; one exposure: the largest 98th percentile is white.
image::Image8 strip(const std::vector<image::Image>& pictures) {
  float white = 0;
  for (const image::Image& picture : pictures) {
    std::vector<float> values = picture.pixels;
    std::nth_element(values.begin(), values.begin() + ptrdiff_t(values.size() * 49 / 50), values.end());
    white = std::max(white, values[values.size() * 49 / 50]);
  }
  constexpr uint32_t gap = 4;
  const uint32_t width = pictures[0].width, height = pictures[0].height;
  const uint32_t all = uint32_t(pictures.size()) * (width + gap) - gap;
  image::Image8 out{all, height, 3, std::vector<uint8_t>(size_t(all) * height * 3, 255)};
  for (size_t n = 0; n < pictures.size(); ++n)
    for (uint32_t y = 0; y < height; ++y)
      for (uint32_t x = 0; x < width; ++x)
        for (uint32_t c = 0; c < 3; ++c) {
          const image::Image& p = pictures[n];
          const float value = p.pixels[(size_t(y) * width + x) * p.channels + std::min(c, p.channels - 1)] / white;
          out.pixels[(size_t(y) * all + n * (width + gap) + x) * 3 + c] =
              uint8_t(std::lround(255 * std::clamp(image::srgb_from_linear(value), 0.0f, 1.0f)));
        }
  return out;
}

constexpr const char* figure_parts[] = {"total", "estimator", "missing"};

void check_shown(const std::string& what, const std::string& where) {
  const std::string id = what.substr(0, what.find('.')), rest = what.substr(std::min(what.find('.') + 1, what.size()));
  bool good = false;
  for (const Quantity& q : quantities()) good |= id == q.id;
  bool known = rest == "variance" || rest == "flip" || rest == "relmse";
  for (const char* part : figure_parts)
    for (const char* measure : {"rmse", "bias"}) known |= rest == fmt::format("{}.{}", part, measure);
  if (!good || !known)
    fail(Exit::Input, "'{}' cannot show '{}': write e.g. visibility.total.rmse, gi_1.estimator.bias, gi_1.variance",
         where, what);
}

}  // namespace

Figures::Figures(const fs::path& file, const fs::path& scenes) : spec_(read_spec(file, "nearfield.paper_figures/1")) {
  try {
    expect_keys(spec_, file.filename().string(), {"schema", "figures", "not_made"});
    for (const json& figure : spec_.at("figures")) {
      const std::string where = "figures." + figure.at("id").get<std::string>();
      expect_keys(figure, where,
                  {"id", "title", "source", "scene", "view", "base", "variants", "show", "picture", "notes"});
      Place place{(scenes / figure.at("scene").get<std::string>()).string(), figure.value("view", ""), ""};
      if (place.view.ends_with(".json")) place.view = (scenes / place.view).string();
      place.label = where;
      if (!fs::is_regular_file(place.scene))
        fail(Exit::Input, "'{}' needs the scene '{}': build the target nearfield_scenes", where, place.scene);
      places_.push_back(place);
      std::vector<Contender> contenders;
      for (const json& variant : figure.at("variants")) {
        expect_keys(variant, where + ".variants", {"label", "technique", "mode", "params"});
        Contender c{.label = variant.at("label"), .mode = variant.value("mode", "radiometric")};
        json base = {{"material.lambert", true}};
        base.update(figure.value("base", json::object()));
        c.settings = spec_settings(variant, base);
        c.settings.reconstruct = false;
        c.technique = c.settings.technique->id;
        contenders.push_back(std::move(c));
      }
      contenders_.push_back(std::move(contenders));
      for (const json& what : figure.at("show")) check_shown(what, where);
    }
  } catch (const json::exception& e) {
    fail(Exit::Input, "bad figures '{}': {}", file.string(), e.what());
  }
}

size_t Figures::cells() const {
  size_t count = 0;
  for (const auto& contenders : contenders_) count += contenders.size();
  return count;
}

bool Figures::run(gpu::Device& device, const EvaluateOptions& options, TruthStore& store, const fs::path& pictures,
                  const std::function<void(size_t, const std::string&)>& notice) {
  frames_ = options.frames;
  size_t done = 0;
  for (size_t i = 0; i < places_.size(); ++i) {
    json figure = spec_["figures"][i];
    const std::string id = figure["id"], pictured = figure.value("picture", "");
    // Light of many bounces is dear, and measured where it is shown.
    EvaluateOptions own = options;
    own.pictures = false;
    bool bounces = false;
    for (const json& what : figure["show"]) bounces |= what.get<std::string>().starts_with("gi_n");
    if (!bounces) own.bounces = 0;
    Stage stage(device, own, places_[i]);
    std::vector<image::Image> strips;
    image::Image truth;
    json rows = json::array();
    for (const Contender& contender : contenders_[i]) {
      notice(done++, fmt::format("{}, {}", id, contender.label));
      stage.on_means = [&](const Quantity& q, const image::Image& test, const image::Image& path) {
        if (q.id != pictured) return;
        strips.push_back(test);
        truth = path;
      };
      rows.push_back(stage.measure(contender, store, {}));
      if (!rows.back().is_object()) return false;
    }
    if (!strips.empty()) {
      strips.push_back(truth);
      const std::string name = id + ".png";
      image::write_png(pictures / name, strip(strips));
      figure["picture_file"] = name;
    }
    figure["rows"] = rows;
    results_.push_back(figure);
  }
  return true;
}

json Figures::document() const {
  return {{"schema", "nearfield.paper_figures_result/1"},
          {"figures", results_},
          {"not_made", spec_.value("not_made", json::array())}};
}

std::string Figures::markdown(const EvaluateOptions& o, const std::string& pictures) const {
  std::string text = fmt::format(
      "# Figures of the papers, as numbers\n\n`{}`\n\n{}, means of {} frames, references of {} samples a pixel, {} "
      "bounces for gi_n. What is not said is at its default; all materials are Lambert. total: against the path "
      "tracer; "
      "estimator: against a perfect estimator with the same data; rmse and bias, of light in % of the path-traced "
      "mean; "
      "variance: of a pixel's value in one frame, over the square of that mean; < x: not told from none.\n",
      command_line(), o.size, o.frames, o.spp, o.bounces);
  for (const json& figure : results_) {
    text += fmt::format("\n## {}\n\n{}. {}{}.\n\n", figure["title"].get<std::string>(),
                        figure["source"].get<std::string>(), figure["scene"].get<std::string>(),
                        figure.contains("view") ? ", " + figure["view"].get<std::string>() : "");
    std::vector<std::string> head = {"variant"};
    for (const json& what : figure["show"]) head.push_back(what);
    std::vector<std::vector<std::string>> rows;
    for (const json& row : figure["rows"]) {
      std::vector<std::string> cells = {row["contender"]};
      for (const json& what : figure["show"]) cells.push_back(shown_value(row, what, frames_));
      rows.push_back(cells);
    }
    text += markdown_table(head, rows);
    if (figure.contains("picture_file"))
      text += fmt::format("\n![{}, by row of the table; last: path traced]({}/{})\n",
                          figure["picture"].get<std::string>(), pictures, figure["picture_file"].get<std::string>());
    for (const json& note : figure.value("notes", json::array()))
      text += fmt::format("\n{}\n", note.get<std::string>());
  }
  text += "\n## Not made\n\n";
  for (const json& what : spec_.value("not_made", json::array()))
    text += fmt::format("- {}\n", what.get<std::string>());
  return text;
}

}  // namespace nf::editor
