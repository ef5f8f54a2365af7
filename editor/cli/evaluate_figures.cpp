// The papers' figures as numbers: settings from a data file, measured as every other cell, in small tables.
#include <algorithm>
#include <cmath>

#include "cli/evaluate.h"
#include "cli/paper_spec.h"
#include "image/file.h"
#include "image/ring.h"

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
  if (id == "shading") return q[rest].is_null() ? "–" : fmt::format("{:.2f}", q[rest].get<double>());
  if (rest == "share") return fmt::format("{:.1f} %", 100 * q["share"].get<double>());
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

constexpr const char* figure_parts[] = {"total", "estimator", "missing", "ring"};

// What a figure of frames shows, by its kind.
bool of_frames(const json& figure) {
  return figure.contains("kind");
}
std::vector<std::string> frame_columns(const json& figure) {
  const std::string kind = figure["kind"];
  if (kind == "noise") return {"pixel", "4x4"};
  if (kind == "holes") return {"holes", "holes left", "rmse of holes", "rmse of others"};
  if (kind == "direct") return {"rmse", "bias", "shadow found", "shadow made up"};
  fail(Exit::Input, "bad kind '{}' of '{}': noise, holes or direct", kind, figure["id"].get<std::string>());
}
std::string frame_value(const json& row, const std::string& column) {
  const json& value = row[column];
  if (value.is_null()) return "–";
  if (value.is_object()) {
    const double rmse = value["rmse"], floor = value["floor"];
    return fmt::format("{}{:.1f} %", rmse < floor ? "< " : "", 100 * std::max(rmse, floor));
  }
  const double x = value;
  if (column == "bias") return fmt::format("{:+.1f} %", 100 * x);
  return column == "pixel" || column == "4x4" ? fmt::format("{:.3g}", x) : fmt::format("{:.1f} %", 100 * x);
}

// Light of the environment and one bounce as it leaves the surfaces; `gi` may be empty.
image::Image outgoing(const image::Image& ambient, const image::Image& gi, const std::vector<glm::vec3>& albedo,
                      double& bounced, const std::vector<uint8_t>& mask) {
  image::Image out = ambient;
  for (size_t i = 0; i < albedo.size() && !gi.pixels.empty(); ++i)
    for (uint32_t c = 0; c < 3; ++c) {
      const float light = albedo[i][int(c)] * gi.pixels[i * gi.channels + c];
      out.pixels[i * out.channels + c] += light;
      if (mask[i]) bounced += double(light);
    }
  return out;
}

// "indirect": the sum of what the technique makes of ambient light and of bounced light, against the path tracer's.
json indirect_errors(const FigureMeans& of, const image::Halves& ambient, const image::Halves& true_gi,
                     const std::vector<glm::vec3>& albedo) {
  double bounced = 0, unused = 0;
  const image::Halves test{outgoing(ambient.a, of.gi.a, albedo, bounced, of.mask),
                           outgoing(ambient.b, of.gi.b, albedo, bounced, of.mask)},
      truth{outgoing(of.true_ambient.a, true_gi.a, albedo, unused, of.mask),
            outgoing(of.true_ambient.b, true_gi.b, albedo, unused, of.mask)};
  const auto sum = [&](const image::Image& picture) { return image::bias({picture, picture, of.mask}).reference; };
  const image::ErrorPart part = image::error_between(test, truth, of.mask);
  const double pixels = double(std::count(of.mask.begin(), of.mask.end(), 1)) * 3 * 2;
  return {{"reference_mean", sum(image::mean_of(truth))},
          {"share", bounced / pixels / sum(image::mean_of(test))},
          {"total", {{"rmse", part.rmse}, {"bias", part.bias}, {"floor", part.floor}}}};
}

void check_shown(const std::string& what, const std::string& where) {
  const std::string id = what.substr(0, what.find('.')), rest = what.substr(std::min(what.find('.') + 1, what.size()));
  bool good = false;
  for (const Quantity& q : quantities()) good |= id == q.id;
  bool known = rest == "variance" || rest == "flip" || rest == "relmse";
  if (what == "shading.change" || what == "shading.correlation") return;
  if (id == "indirect" && (rest == "share" || rest == "total.rmse" || rest == "total.bias")) return;
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
                  {"id", "title", "source", "scene", "view", "base", "variants", "show", "picture", "notes", "ring",
                   "turned", "kind"});
      if (of_frames(figure)) frame_columns(figure);
      if (figure.contains("ring")) expect_keys(figure["ring"], where + ".ring", {"reach", "gap"});
      Place place{(scenes / figure.at("scene").get<std::string>()).string(), figure.value("view", ""), ""};
      if (place.view.ends_with(".json")) place.view = (scenes / place.view).string();
      place.label = where;
      if (!fs::is_regular_file(place.scene))
        fail(Exit::Input, "'{}' needs the scene '{}': build the target nearfield_scenes", where, place.scene);
      places_.push_back(place);
      std::vector<Contender> contenders;
      for (const json& variant : figure.at("variants")) {
        expect_keys(variant, where + ".variants",
                    {"label", "technique", "mode", "params", "ambient_of", "frames", "moved", "turned"});
        Contender c{.label = variant.at("label"), .mode = variant.value("mode", "radiometric")};
        json base = {{"material.lambert", true}};
        base.update(figure.value("base", json::object()));
        c.settings = spec_settings(variant, base);
        c.settings.reconstruct = of_frames(figure);
        c.technique = c.settings.technique->id;
        contenders.push_back(std::move(c));
      }
      contenders_.push_back(std::move(contenders));
      for (const json& what : figure.value("show", json::array())) check_shown(what, where);
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
    if (of_frames(figure)) {
      std::vector<image::Image> shown;
      figure["rows"] = frame_rows(device, options, store, i, shown, [&](const std::string& label) {
        notice(done++, fmt::format("{}, {}", figure["id"].get<std::string>(), label));
      });
      if (figure["rows"].is_null()) return false;
      if (!shown.empty() && !figure.value("picture", "").empty()) {
        figure["picture_file"] = figure["id"].get<std::string>() + ".png";
        image::write_png(pictures / figure["picture_file"].get<std::string>(), strip(shown));
      }
      results_.push_back(figure);
      continue;
    }
    const std::string id = figure["id"], pictured = figure.value("picture", "");
    // Light of many bounces is dear, and measured where it is shown.
    EvaluateOptions own = options;
    own.pictures = false;
    bool bounces = false;
    bool indirect = false;
    for (const json& what : figure["show"]) {
      bounces |= what.get<std::string>().starts_with("gi_n");
      indirect |= what.get<std::string>().starts_with("indirect");
    }
    const bool turned = figure.contains("turned");
    std::vector<FigureMeans> means;
    if (!bounces) own.bounces = 0;
    Stage stage(device, own, places_[i]);
    std::vector<image::Image> strips;
    image::Image truth;
    json rows = json::array();
    for (const Contender& contender : contenders_[i]) {
      notice(done++, fmt::format("{}, {}", id, contender.label));
      json rings = json::object();
      means.push_back({.label = contender.label});
      stage.on_means = [&](const Quantity& q, const image::Halves& test, const image::Halves& path,
                           const std::vector<uint8_t>& mask) {
        if (figure.contains("ring")) {
          std::vector<uint8_t> ring =
              image::ring_behind(stage.buffers().depth, test.a.width, figure["ring"]["reach"], figure["ring"]["gap"]);
          for (size_t p = 0; p < ring.size(); ++p) ring[p] &= mask[p];
          const image::ErrorPart part = image::error_between(test, path, ring);
          rings[q.id] = {{"rmse", part.rmse},
                         {"bias", part.bias},
                         {"floor", part.floor},
                         {"pixels", std::count(ring.begin(), ring.end(), 1)}};
        }
        FigureMeans& kept = means.back();
        if ((indirect || turned) && q.id == std::string_view("ambient"))
          kept.ambient = test, kept.true_ambient = path, kept.mask = mask;
        if (indirect && q.id == std::string_view("gi_1")) kept.gi = test, kept.true_gi = path;
        if (q.id != pictured) return;
        strips.push_back(image::mean_of(test));
        truth = image::mean_of(path);
      };
      rows.push_back(stage.measure(contender, store, {}));
      if (!rows.back().is_object()) return false;
      for (const auto& [quantity, part] : rings.items()) rows.back()["quantities"][quantity]["ring"] = part;
    }
    for (size_t n = 0; indirect && n < rows.size(); ++n) {
      const std::string from = spec_["figures"][i]["variants"][n].value("ambient_of", means[n].label);
      const image::Halves *ambient = nullptr, *true_gi = nullptr;
      for (const FigureMeans& other : means) {
        if (other.label == from) ambient = &other.ambient;
        if (!other.true_gi.a.pixels.empty()) true_gi = &other.true_gi;
      }
      if (!ambient || !true_gi || means[n].ambient.a.pixels.empty())
        fail(Exit::Input,
             "'{}' shows indirect light: it needs ambient light in view, a variant that gives gi, and an "
             "'ambient_of' that is a variant's label",
             id);
      rows[n]["quantities"]["indirect"] = indirect_errors(means[n], *ambient, *true_gi, stage.buffers().albedo);
    }
    if (turned && !add_shading(device, own, store, i, means, rows)) return false;
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

// How a technique shades is what it makes of ambient light over what `none` does. `change`: how much of that changes
// with the environment, root mean square, over the truth's; `correlation`: of both changes. Products are of different
// halves, so noise has no part in their means.
bool Figures::add_shading(gpu::Device& device, const EvaluateOptions& options, TruthStore& store, size_t figure,
                          const std::vector<FigureMeans>& means, json& rows) {
  Place place = places_[figure];
  const std::string view = spec_["figures"][figure]["turned"];
  place.view = view.ends_with(".json") ? (fs::path(place.scene).parent_path() / view).string() : view;
  Stage stage(device, options, place);
  std::vector<FigureMeans> others;
  for (const Contender& contender : contenders_[figure]) {
    others.push_back({.label = contender.label});
    stage.on_means = [&](const Quantity& q, const image::Halves& test, const image::Halves& path,
                         const std::vector<uint8_t>&) {
      if (q.id == std::string_view("ambient")) others.back().ambient = test, others.back().true_ambient = path;
    };
    if (!stage.measure(contender, store, {}).is_object()) return false;
  }
  size_t open = 0;
  while (open < means.size() && contenders_[figure][open].technique != "none") ++open;
  if (open == means.size() || means[open].ambient.a.pixels.empty() || others[open].ambient.a.pixels.empty())
    fail(Exit::Input, "'{}' shows shading: it needs a variant of the technique none, and ambient light in both views",
         place.label);
  const image::Image before = image::mean_of(means[open].ambient), after = image::mean_of(others[open].ambient);
  for (size_t n = 0; n < rows.size(); ++n) {
    double test = 0, truth = 0, both = 0;
    const auto change = [&](const image::Image& b, const image::Image& a, size_t p) {
      return double(b.pixels[p]) / double(after.pixels[p]) - double(a.pixels[p]) / double(before.pixels[p]);
    };
    for (size_t p = 0; p < before.pixels.size(); ++p) {
      if (!means[n].mask[p / before.channels] || p % before.channels > 2) continue;
      if (before.pixels[p] <= 0 || after.pixels[p] <= 0) continue;
      const double ta = change(others[n].ambient.a, means[n].ambient.a, p),
                   tb = change(others[n].ambient.b, means[n].ambient.b, p),
                   pa = change(others[n].true_ambient.a, means[n].true_ambient.a, p),
                   pb = change(others[n].true_ambient.b, means[n].true_ambient.b, p);
      test += ta * tb, truth += pa * pb, both += (ta * pb + tb * pa) / 2;
    }
    // Without a change there is nothing to correlate.
    const double size = truth > 0 && test > 0 ? std::sqrt(test / truth) : 0;
    rows[n]["quantities"]["shading"] = {{"change", size},
                                        {"correlation", size > 1e-3 ? json(both / std::sqrt(test * truth)) : json()}};
  }
  return true;
}

json Figures::frame_rows(gpu::Device& device, const EvaluateOptions& options, TruthStore& store, size_t figure,
                         std::vector<image::Image>& pictures, const std::function<void(const std::string&)>& notice) {
  FrameStage stage(device, options, places_[figure]);
  const json& spec = spec_["figures"][figure];
  const std::string kind = spec["kind"];
  json rows = json::array();
  image::Image seen, truth;
  for (size_t n = 0; n < contenders_[figure].size(); ++n) {
    const Contender& contender = contenders_[figure][n];
    const json& variant = spec["variants"][n];
    notice(contender.label);
    const std::vector<float> by = variant.value("moved", std::vector<float>{0, 0, 0});
    json row = kind == "noise" ? stage.noise(contender.settings, variant.value("frames", 1u))
               : kind == "direct"
                   ? stage.direct(contender.settings, store, seen, truth)
                   : stage.holes(contender.settings, {by.at(0), by.at(1), by.at(2)}, variant.value("turned", 0.0f));
    if (row.is_null()) return nullptr;
    row["contender"] = contender.label;
    rows.push_back(row);
    if (kind == "direct") pictures.push_back(seen);
  }
  if (kind == "direct") pictures.push_back(truth);
  return rows;
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
    const std::vector<std::string> columns =
        of_frames(figure) ? frame_columns(figure) : figure["show"].get<std::vector<std::string>>();
    head.insert(head.end(), columns.begin(), columns.end());
    std::vector<std::vector<std::string>> rows;
    for (const json& row : figure["rows"]) {
      std::vector<std::string> cells = {row["contender"]};
      for (const std::string& what : columns)
        cells.push_back(of_frames(figure) ? frame_value(row, what) : shown_value(row, what, frames_));
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
