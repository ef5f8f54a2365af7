// The path tracer in the background: its state, how far the picture is from it, and how that changes with its samples.
#include <algorithm>
#include <cmath>
#include <imgui.h>

#include "panels/panels.h"
#include "refine.h"
#include "ui/widgets.h"

namespace nf::editor {
namespace {

void draw_curve(const std::vector<ReferenceView::Point>& curve) {
  const float height = ImGui::GetFontSize() * 8, width = std::max(ImGui::GetContentRegionAvail().x, 20.0f);
  const ImVec2 low = ImGui::GetCursorScreenPos();
  ImGui::InvisibleButton("curve", ImVec2(width, height));
  ui::note("reference.curve", fmt::format("{}", curve.size()));
  ImDrawList* list = ImGui::GetWindowDrawList();
  list->AddRectFilled(low, ImVec2(low.x + width, low.y + height), IM_COL32(24, 24, 28, 255));
  if (curve.size() < 2) return;
  float least = INFINITY, most = 0;
  for (const ReferenceView::Point& p : curve)
    for (const float x : {p.rmse, p.floor})
      if (x > 0) least = std::min(least, x), most = std::max(most, x);
  if (!(most > 0)) return;
  least = std::min(least, most * 0.5f);
  const float first = std::log(curve.front().spp), last = std::max(std::log(curve.back().spp), first + 0.1f);
  const auto place = [&](float spp, float x) {
    const float u = (std::log(spp) - first) / (last - first);
    const float v =
        (std::log(std::max(x, least)) - std::log(least)) / std::max(std::log(most) - std::log(least), 1e-6f);
    return ImVec2(low.x + 4 + u * (width - 8), low.y + height - 4 - v * (height - 8));
  };
  for (size_t i = 1; i < curve.size(); ++i) {
    list->AddLine(place(curve[i - 1].spp, curve[i - 1].floor), place(curve[i].spp, curve[i].floor),
                  IM_COL32(150, 150, 150, 255), 1.5f);
    list->AddLine(place(curve[i - 1].spp, curve[i - 1].rmse), place(curve[i].spp, curve[i].rmse),
                  IM_COL32(86, 180, 233, 255), 2);
  }
  list->AddText(ImVec2(low.x + 4, low.y + 2), IM_COL32(230, 230, 230, 255), fmt::format("{:.3g}", most).c_str());
  list->AddText(ImVec2(low.x + 4, low.y + height - ImGui::GetFontSize() - 2), IM_COL32(230, 230, 230, 255),
                fmt::format("{:.3g}", least).c_str());
  if (ImGui::IsItemHovered())
    ImGui::SetTooltip(
        "RMSE of the picture (blue) and the noise of the reference (grey),\nby samples a pixel, both logarithmic");
}

void row(const char* id, const char* name, const std::string& value, const char* help) {
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  ImGui::TextUnformatted(name);
  ui::tooltip(help);
  ImGui::TableNextColumn();
  ImGui::TextUnformatted(value.c_str());
  ui::note(std::string("reference.") + id, value);
}

// One part's map; pointed at, it stands in the viewport, and clicked it stays there.
void draw_map(Editor& editor, ui::PictureId id, const char* name, float width) {
  const LiveSplit::Result& p = editor.reference.parts;
  Preview preview{fmt::format("{} error, white = {:.3g}", name, p.range),
                  id,
                  {.map = ui::Map::FalseColor, .low = 0, .high = p.range}};
  const ImVec2 size(width, std::max(width * float(p.size.y) / float(std::max(p.size.x, 1u)), 1.0f));
  ImGui::BeginGroup();
  if (void* picture = editor.pictures->show(id, preview.look))
    ImGui::Image(picture, size);
  else
    ImGui::Dummy(size);
  const bool clicked = ImGui::IsItemClicked(), hovered = ImGui::IsItemHovered();
  ui::note(std::string("reference.map.") + name, fmt::format("{} {}", p.size.x, p.size.y));
  ImGui::TextUnformatted(name);
  ImGui::EndGroup();
  point_at(editor, std::move(preview), hovered, clicked);
}

void draw_split(Editor& editor) {
  ReferenceView& r = editor.reference;
  ImGui::Separator();
  ui::checkbox("reference.split", "error split: total = estimator + missing", r.split,
               "Estimator: the technique against random rays through the same depth, normals and light, which is the "
               "best that can be made of the screen. Missing: that against the path tracer, which is what the screen "
               "does not show. While it is on the picture is the technique's own: no reconstruction, no feedback, no "
               "antialiasing, as `nearfield evaluate` measures it.");
  if (!r.split) return;
  std::vector<std::string> names;
  for (const SplitQuantity& q : split_quantities()) names.emplace_back(q.name);
  ImGui::SetNextItemWidth(ImGui::GetFontSize() * 8);
  ui::combo("reference.split.quantity", "", r.quantity, names);
  if (!r.split_note.empty()) ImGui::TextWrapped("%s", r.split_note.c_str());
  if (!r.has_parts) {
    ImGui::TextDisabled("the first samples are on their way ...");
    return;
  }
  const LiveSplit::Result& p = r.parts;
  ImGui::TextWrapped("%u frames; %u samples a pixel traced, %u marched, in %.1f s%s; mean of the truth %.4g", p.frames,
                     p.spp, p.march_spp, p.seconds, p.complete ? ", done" : "", p.level);
  ui::note("reference.split.spp", fmt::format("{}", p.spp));
  if (ImGui::BeginTable("parts", 4, ImGuiTableFlags_RowBg)) {
    for (const char* head : {"part", "bias", "RMSE", "floor"}) ImGui::TableSetupColumn(head);
    ImGui::TableHeadersRow();
    const std::pair<const char*, const image::ErrorPart*> rows[] = {
        {"total", &p.split.total}, {"estimator", &p.split.estimator}, {"missing", &p.split.missing}};
    for (const auto& [name, part] : rows) {
      ImGui::TableNextRow();
      ImGui::TableNextColumn();
      ImGui::TextUnformatted(name);
      ImGui::TableNextColumn();
      ImGui::Text("%+.4g", part->bias);
      ui::note(fmt::format("reference.split.{}.bias", name), fmt::format("{:.6g}", part->bias));
      ImGui::TableNextColumn();
      ImGui::Text("%.4g", part->rmse);
      ui::note(fmt::format("reference.split.{}", name), fmt::format("{:.6g}", part->rmse));
      ImGui::TableNextColumn();
      ImGui::TextDisabled("%.2g", part->floor);
    }
    ImGui::EndTable();
  }
  const float gap = ImGui::GetStyle().ItemSpacing.x;
  const float width = std::max((ImGui::GetContentRegionAvail().x - 2 * gap) / 3, 8.0f);
  draw_map(editor, ui::PictureId::SplitTotal, "total", width);
  ImGui::SameLine();
  draw_map(editor, ui::PictureId::SplitEstimator, "estimator", width);
  ImGui::SameLine();
  draw_map(editor, ui::PictureId::SplitMissing, "missing", width);
  ImGui::TextDisabled("absolute errors, %.3g = the brightest; pointed at: in the viewport", double(p.range));
}

}  // namespace

void draw_reference_panel(Editor& editor) {
  ReferenceView& r = editor.reference;
  ui::checkbox("reference.on", "path trace this view", r.on, "In the background, while the picture stands still (R)");
  ImGui::SetNextItemWidth(ImGui::GetFontSize() * 8);
  ui::slider_int("reference.bounces", "bounces", r.bounces, 1, 16);
  ui::tooltip("Of gi. One without feedback; with it, as many as it has had frames.");
  if (!r.note.empty()) ImGui::TextWrapped("%s", r.note.c_str());
  if (!r.on) return;
  if (r.picture.spp == 0) {
    ImGui::TextDisabled("the first samples are on their way ...");
    return;
  }
  ImGui::Text("%u samples a pixel in %.1f s%s", r.picture.spp, r.picture.seconds, r.picture.complete ? ", done" : "");
  ui::note("reference.spp", fmt::format("{}", r.picture.spp));
  if (const LiveReference::Layer* layer = r.picture.layer(r.layer);
      layer && ImGui::BeginTable("errors", 2, ImGuiTableFlags_RowBg)) {
    row("layer", "layer", r.layer.empty() ? "final radiance" : r.layer,
        "What is compared: the layer that the viewport shows, if the reference has it");
    row("noise", "its own noise", fmt::format("{:.4g} of {:.4g}", layer->noise, layer->level),
        "RMSE of the reference's mean, by its two halves; and its mean value");
    if (r.has_error) {
      const LiveError& e = r.error;
      row("rmse", "RMSE", fmt::format("{:.4g} (floor {:.4g})", e.rmse, e.rmse_floor),
          "Of the picture, the reference's noise left out; below the floor it is none that can be told");
      row("relmse", "relMSE", fmt::format("{:.4g}", e.relmse), "Squared differences by squared reference");
      row("bias", "bias", fmt::format("{:+.4g}", e.bias), "Mean of picture less reference");
      row("mae", "MAE", fmt::format("{:.4g} (noise {:.4g})", e.mae, e.mae_floor),
          "Mean absolute difference; the noise alone would give the second");
    }
    ImGui::EndTable();
  }
  draw_curve(r.curve);
  if (ui::button("reference.wipe", "wipe", "The reference on the left")) {
    editor.viewport.against = ui::PictureId::Reference;
    editor.viewport.compare = CompareMode::Wipe;
  }
  ImGui::SameLine();
  if (ui::button("reference.heat", "heat map", "|picture - reference| in false colours")) {
    editor.viewport.against = ui::PictureId::Reference;
    editor.viewport.compare = CompareMode::Difference;
  }
  ImGui::SameLine();
  if (ui::button("reference.csv", "save curve", "CSV: samples, RMSE, noise")) editor.save_curve = true;
  draw_split(editor);
}

}  // namespace nf::editor
