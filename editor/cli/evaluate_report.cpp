// The table as JSON, Markdown and HTML.
#include <algorithm>
#include <cmath>

#include "cli/evaluate.h"
#include "cli/paper_spec.h"

namespace nf::editor {
namespace {

using nlohmann::json;

constexpr const char* parts[] = {"total", "estimator", "missing"};

// A part of a row's error, or a dash: "0.0312 (-0.0041)", or in % of the mean.
std::string part_text(const json& row, const Quantity& q, const char* part) {
  const auto found = row["quantities"].find(q.id);
  if (found == row["quantities"].end() || !found->contains(part)) return "–";
  const json& value = (*found)[part];
  if (!value["rmse"].is_number() || !value["bias"].is_number()) return "not finite";
  const double rmse = value["rmse"], bias = value["bias"], floor = value["floor"];
  const double unit = q.of_mean ? 0.01 * found->value("reference_mean", 1.0) : 1;
  const char* below = rmse < floor ? "< " : "";
  const double shown = std::max(rmse, floor) / unit;
  if (q.of_mean) return fmt::format("{}{:.1f} % ({:+.1f})", below, shown, bias / unit);
  return fmt::format("{}{:.4f} ({:+.4f})", below, shown, bias / unit);
}

std::string ms_text(const json& row, const char* which) {
  return row["ms"].is_object() ? fmt::format("{:.2f}", row["ms"][which].get<double>()) : "–";
}

// Share of the samples that added nothing.
std::string idle_text(double share) {
  return fmt::format("{:.0f} %", 100 * share);
}

// One table as rows of cells: what Markdown and HTML both show.
struct Table {
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;
};

// Quantities that any row of these has.
std::vector<const Quantity*> present(const std::vector<const json*>& rows) {
  std::vector<const Quantity*> out;
  for (const Quantity& q : quantities())
    if (std::any_of(rows.begin(), rows.end(), [&](const json* row) { return (*row)["quantities"].contains(q.id); }))
      out.push_back(&q);
  return out;
}

Table place_table(const std::vector<const json*>& rows) {
  Table table{{"technique", "radius", "idle samples", "ms", "frame ms"}, {}};
  const std::vector<const Quantity*> shown = present(rows);
  for (const Quantity* q : shown)
    for (const char* part : parts) table.head.push_back(fmt::format("{}: {}", q->title, part));
  for (const json* row : rows) {
    std::vector<std::string> cells = {(*row)["contender"], (*row)["radius"],
                                      (*row)["samples"].is_object() ? idle_text((*row)["samples"]["idle"]) : "–",
                                      ms_text(*row, "technique"), ms_text(*row, "frame")};
    for (const Quantity* q : shown)
      for (const char* part : parts) cells.push_back(part_text(*row, *q, part));
    table.rows.push_back(cells);
  }
  return table;
}

// Means over the places: RMSE of visibility, and RMSE over the mean of the others.
Table summary_table(const json& document) {
  Table table{{"technique", "views", "idle samples", "ms"}, {}};
  std::vector<const json*> all;
  for (const json& row : document["rows"]) all.push_back(&row);
  const std::vector<const Quantity*> shown = present(all);
  for (const Quantity* q : shown)
    for (const char* part : parts) table.head.push_back(fmt::format("{}: {}", q->title, part));
  std::vector<std::string> contenders;
  for (const json* row : all)
    if (std::find(contenders.begin(), contenders.end(), (*row)["contender"]) == contenders.end())
      contenders.push_back((*row)["contender"]);
  for (const std::string& contender : contenders) {
    uint32_t views = 0, told = 0;
    double ms = 0, idle = 0;
    for (const json* row : all) {
      if ((*row)["contender"] != contender) continue;
      ++views, ms += (*row)["ms"].is_object() ? double((*row)["ms"]["technique"]) : 0;
      if ((*row)["samples"].is_object()) ++told, idle += double((*row)["samples"]["idle"]);
    }
    std::vector<std::string> cells = {contender, fmt::format("{}", views), told ? idle_text(idle / told) : "–",
                                      fmt::format("{:.2f}", ms / views)};
    for (const Quantity* q : shown) {
      for (const char* part : parts) {
        double sum = 0;
        uint32_t count = 0;
        for (const json* row : all) {
          if ((*row)["contender"] != contender) continue;
          const auto found = (*row)["quantities"].find(q->id);
          if (found == (*row)["quantities"].end() || !found->contains(part)) continue;
          if (!(*found)[part]["rmse"].is_number()) continue;
          sum += double((*found)[part]["rmse"]) / (q->of_mean ? double((*found)["reference_mean"]) : 1);
          ++count;
        }
        cells.push_back(!count       ? "–"
                        : q->of_mean ? fmt::format("{:.1f} %", 100 * sum / count)
                                     : fmt::format("{:.4f}", sum / count));
      }
    }
    table.rows.push_back(cells);
  }
  return table;
}

// A number of a row, by its path; NaN where there is none.
double number_at(const json* row, std::initializer_list<const char*> path) {
  for (const char* key : path) {
    if (!row || !row->is_object()) return std::nan("");
    const auto found = row->find(key);
    row = found == row->end() ? nullptr : &*found;
  }
  return row && row->is_number() ? row->get<double>() : std::nan("");
}

// What fewer pixels cost and save: each number, and in brackets how many times full resolution's it is. No rows where
// no resolution was asked for.
Table resolution_table(const std::vector<const json*>& rows) {
  Table table{{"technique", "ms"}, {}};
  const std::vector<const Quantity*> shown = present(rows);
  for (const Quantity* q : shown)
    for (const char* column : {"total", "estimator", "one frame"})
      if (!q->with_bounces || *column != 'o') table.head.push_back(fmt::format("{}: {}", q->title, column));
  for (const json* row : rows) {
    const std::string contender = (*row)["contender"], resolution = row->value("resolution", "");
    if (resolution.empty()) continue;
    const std::string full_one = contender.substr(0, contender.rfind('@')) + "@full";
    const auto full =
        std::find_if(rows.begin(), rows.end(), [&](const json* r) { return (*r)["contender"] == full_one; });
    const auto beside = [&](const Quantity* q, std::initializer_list<const char*> path) -> std::string {
      const double value = number_at(row, path), of_full = full == rows.end() ? 0 : number_at(*full, path);
      if (!std::isfinite(value)) return "–";
      const double mean = q ? number_at(row, {"quantities", q->id, "reference_mean"}) : 1;
      const std::string text = !q           ? fmt::format("{:.2f}", value)
                               : q->of_mean ? fmt::format("{:.1f} %", 100 * value / mean)
                                            : fmt::format("{:.4f}", value);
      return of_full > 0 ? fmt::format("{} ({:.2f})", text, value / of_full) : text;
    };
    std::vector<std::string> cells = {contender, beside(nullptr, {"ms", "technique"})};
    for (const Quantity* q : shown) {
      cells.push_back(beside(q, {"quantities", q->id, "total", "rmse"}));
      cells.push_back(beside(q, {"quantities", q->id, "estimator", "rmse"}));
      if (!q->with_bounces) cells.push_back(beside(q, {"quantities", q->id, "single_frame_rmse"}));
    }
    table.rows.push_back(cells);
  }
  return table;
}

std::string markdown_of(const Table& table) {
  return markdown_table(table.head, table.rows);
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '<' ? "&lt;" : c == '&' ? "&amp;" : std::string(1, c);
  return out;
}

std::string html_of(const Table& table) {
  std::string text = "<table><thead><tr>";
  for (const std::string& cell : table.head) text += fmt::format("<th>{}</th>", escaped(cell));
  text += "</tr></thead><tbody>\n";
  for (const auto& row : table.rows) {
    text += "<tr>";
    for (const std::string& cell : row) text += fmt::format("<td>{}</td>", escaped(cell));
    text += "</tr>\n";
  }
  return text + "</tbody></table>\n";
}

// Rows by place, in their order.
std::vector<std::pair<std::string, std::vector<const json*>>> by_place(const json& document) {
  std::vector<std::pair<std::string, std::vector<const json*>>> groups;
  for (const json& row : document["rows"]) {
    if (groups.empty() || groups.back().first != row["place"]) groups.push_back({row["place"], {}});
    groups.back().second.push_back(&row);
  }
  return groups;
}

// What a place's numbers stand on: the references' means, the noise left in them.
std::string place_text(const std::vector<const json*>& rows) {
  const json& first = *rows.front();
  const double pixels = first["pixels"], left_out = first["pixels_left_out"];
  std::string text =
      fmt::format("{} pixels, {:.1f} % left out", pixels, 100 * left_out / std::max(pixels + left_out, 1.0));
  for (const Quantity& q : quantities()) {
    for (const json* row : rows) {
      const auto found = (*row)["quantities"].find(q.id);
      if (found == (*row)["quantities"].end()) continue;
      const json& noise = (*found)["noise"];
      text += fmt::format("; {}: mean {:.4g}, noise of the references {:.2g}", q.title,
                          (*found)["reference_mean"].get<double>(), noise["path_traced"].get<double>());
      if (noise.contains("same_information"))
        text += fmt::format(" and {:.2g}", noise["same_information"].get<double>());
      if (found->contains("last_bounce"))
        text += fmt::format(", {:.2g} % of it of the last bounce", 100 * (*found)["last_bounce"].get<double>());
      break;
    }
  }
  for (const json* row : rows)
    if (const std::string note = (*row)["note"]; !note.empty())
      text += fmt::format("; {}: {}", (*row)["contender"].get<std::string>(), note);
  return text + ".";
}

constexpr const char* legend =
    "Each entry is the RMSE and in brackets the mean of the signed error, both of the technique's expected value (the "
    "mean of its frames): of visibility as they are, of light in % of the path-traced mean. total: technique against "
    "path tracer. estimator: technique against random rays through the same depth, normals and light. missing: those "
    "rays against the path tracer, which is what the screen does not show. Noise has no part in an RMSE: it is taken "
    "from products of independent halves; \"< x\" is where that does not tell it from none. Pixels count where "
    "rasteriser and tracer see the same surface. The path "
    "tracer's visibility and gi end at the techniques' radius too, gi at every bounce; its ambient light does not. N "
    "bounces: the technique with feedback, counted from where the loop has settled, so with all the bounces there are; "
    "random rays that gather what they reflected N - 1 times; paths of N bounces. idle samples: of all samples "
    "taken at 64 pixels spread over the picture, the share that changed nothing (background, out of the radius, "
    "nothing new). ms is the median of the "
    "passes that the technique adds. – : the technique does not give this, or the view has no such light.";

constexpr const char* resolution_legend =
    "RMSE as above, and in brackets how many times that of full resolution it is: of the mean of all frames against "
    "the "
    "path tracer (total) and against random rays through the same depth (estimator), and of one frame with its noise "
    "against the path tracer.";

}  // namespace

json evaluation_json(const EvaluateOptions& o, const std::vector<json>& rows, const gpu::DeviceInfo& device,
                     bool complete) {
  return {{"schema", "nearfield.evaluation/1"},
          {"complete", complete},
          {"version", version_line()},
          {"command", fmt::format("{} -o {}", command_line(), o.folder)},
          {"device", {{"name", device.name}, {"type", device.type}, {"driver", device.driver}}},
          {"backend", reference::backend()},
          {"size", {parse_size(o.size).x, parse_size(o.size).y}},
          {"frames", o.frames},
          {"spp", o.spp},
          {"bounces", o.bounces},
          {"seed", o.seed},
          {"timing", o.timing},
          {"rows", rows}};
}

std::string evaluation_markdown(const json& document) {
  std::string text = fmt::format(
      "# Evaluation\n\n`{}`\n\n{}x{}, means of {} frames, references of {} samples a pixel and {} bounces for N; "
      "times on {} ({}).\n",
      document["command"].get<std::string>(), document["size"][0].get<int>(), document["size"][1].get<int>(),
      document["frames"].get<int>(), document["spp"].get<int>(), document["bounces"].get<int>(),
      document["device"]["name"].get<std::string>(), document["device"]["type"].get<std::string>());
  if (!document["complete"].get<bool>()) text += "\n**Interrupted: the table is not complete.**\n";
  text += fmt::format("\n{}\n", legend);
  if (document["rows"].empty()) return text;
  text += "\n## Mean over the views\n\n" + markdown_of(summary_table(document));
  for (const auto& [place, rows] : by_place(document))
    text += fmt::format("\n## {}\n\n{}\n\n{}", place, place_text(rows), markdown_of(place_table(rows)));
  const auto places = by_place(document);
  const auto any = [](const auto& place) { return !resolution_table(place.second).rows.empty(); };
  if (std::none_of(places.begin(), places.end(), any)) return text;
  text += fmt::format("\n## Resolutions\n\n{}\n", resolution_legend);
  for (const auto& [place, rows] : places)
    text += fmt::format("\n{}:\n\n{}", place, markdown_of(resolution_table(rows)));
  return text;
}

std::string evaluation_html(const json& document) {
  std::string text = fmt::format(
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Nearfield: evaluation</title>\n<style>"
      "body{{font:14px/1.4 sans-serif;margin:2em;max-width:120em}}table{{border-collapse:collapse;margin:1em 0}}"
      "th,td{{border:1px solid #bbb;padding:.25em .6em;text-align:right;font-variant-numeric:tabular-nums}}"
      "th{{background:#eee;max-width:9em}}td:first-child,th:first-child{{text-align:left}}figure{{display:inline-block;"
      "margin:.5em}}figcaption{{font-size:12px}}img{{max-width:100%}}</style></head><body>\n<h1>Evaluation</h1>\n"
      "<p><code>{}</code></p>\n<p>{}x{}, means of {} frames, references of {} samples a pixel and {} bounces for N; "
      "times on {} ({}).</p>\n",
      escaped(document["command"]), document["size"][0].get<int>(), document["size"][1].get<int>(),
      document["frames"].get<int>(), document["spp"].get<int>(), document["bounces"].get<int>(),
      escaped(document["device"]["name"]), escaped(document["device"]["type"]));
  if (!document["complete"].get<bool>()) text += "<p><strong>Interrupted: the table is not complete.</strong></p>\n";
  text += fmt::format("<p>{}</p>\n", legend);
  if (!document["rows"].empty()) text += "<h2>Mean over the views</h2>\n" + html_of(summary_table(document));
  for (const auto& [place, rows] : by_place(document)) {
    text += fmt::format("<h2>{}</h2>\n<p>{}</p>\n{}", escaped(place), escaped(place_text(rows)),
                        html_of(place_table(rows)));
    if (const Table table = resolution_table(rows); !table.rows.empty())
      text += fmt::format("<h3>Resolutions</h3>\n<p>{}</p>\n{}", resolution_legend, html_of(table));
    for (const json* row : rows) {
      for (const Quantity& q : quantities()) {
        const auto found = (*row)["quantities"].find(q.id);
        if (found == (*row)["quantities"].end() || !found->contains("picture")) continue;
        text += fmt::format(
            "<figure><img src=\"pictures/{}\" alt=\"\" loading=\"lazy\"><figcaption>{}, {}: total, "
            "estimator, missing</figcaption></figure>\n",
            escaped((*found)["picture"]), escaped((*row)["contender"]), q.title);
      }
    }
  }
  // "</" would end the script.
  std::string data = document.dump();
  for (size_t at = 0; (at = data.find("</", at)) != std::string::npos; at += 3) data.replace(at, 2, "<\\/");
  return text + "<script type=\"application/json\" id=\"data\">" + data + "</script>\n</body></html>\n";
}

}  // namespace nf::editor
