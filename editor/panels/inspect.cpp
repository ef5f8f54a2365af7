// One pixel's values in every layer, and any resource of the frame at any pass.
#include <algorithm>
#include <cmath>
#include <imgui.h>
#include <nlohmann/json.hpp>

#include "panels/panels.h"
#include "ui/widgets.h"

namespace nf::editor {

namespace {

nlohmann::json to_json(const live::Picked& picked) {
  nlohmann::json layers = nlohmann::json::object();
  for (const live::LayerValue& layer : picked.layers) layers[layer.name] = layer.values;
  return {{"pixel", {picked.pixel.x, picked.pixel.y}},
          {"size", {picked.made_with.size.x, picked.made_with.size.y}},
          {"technique", picked.layers.empty() ? "" : picked.made_with.settings.technique->id},
          {"layers", layers}};
}

}  // namespace

void draw_pixel_panel(Editor& editor) {
  const Picking& p = editor.picking;
  editor.pixel_visible = true;
  if (!p.locked) {
    ImGui::TextWrapped("Click into the picture: every layer's value at that pixel stands here.");
    return;
  }
  const live::Picked& values = p.values;
  ImGui::Text("pixel %u, %u of %u x %u", p.pixel.x, p.pixel.y, p.size.x, p.size.y);
  ui::note("pixel.place", fmt::format("{} {}", p.pixel.x, p.pixel.y));
  ImGui::SameLine();
  if (ui::button("pixel.again", "read again")) editor.picking.asked = true;
  ImGui::SameLine();
  if (ui::button("pixel.copy", "copy",
                 "All values as JSON, with all their digits; the arrow keys go to the next pixel"))
    ImGui::SetClipboardText(to_json(values).dump(1).c_str());
  if (values.layers.empty()) {
    ImGui::TextDisabled("reading ...");
    return;
  }
  const live::MadeWith &then = values.made_with, &now = editor.shown_with;
  const bool stale = then.history != now.history || !same(then.camera, now.camera);
  ui::note("pixel.stale", stale ? "true" : "false");
  if (stale)
    ImGui::TextColored(ImVec4(1, 0.85f, 0.5f, 1), "of %s, before the last change: read again",
                       then.settings.technique->id);
  if (!ImGui::BeginTable("layers", 2, ImGuiTableFlags_RowBg | ImGuiTableFlags_ScrollY)) return;
  ImGui::TableSetupColumn("layer", ImGuiTableColumnFlags_WidthFixed, ImGui::GetFontSize() * 7);
  ImGui::TableSetupColumn("value");
  for (const live::LayerValue& layer : values.layers) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(layer.name.c_str());
    ImGui::TableNextColumn();
    std::string text;
    bool finite = true;
    for (const float x : layer.values) {
      text += fmt::format("{}{:.5g}", text.empty() ? "" : "  ", x);
      finite &= std::isfinite(x);
    }
    if (finite)
      ImGui::TextUnformatted(text.c_str());
    else
      ImGui::TextColored(ImVec4(1, 0.4f, 1, 1), "%s", text.c_str());
    ui::note("pixel.layer." + layer.name, text);
  }
  ImGui::EndTable();
}

void draw_texture_panel(Editor& editor) {
  TextureView& t = editor.texture;
  editor.texture_visible = true;
  const live::GraphInfo& g = editor.graph;
  std::vector<std::string> passes, resources;
  int pass = -1, resource = -1;
  for (const live::GraphInfo::Pass& row : g.passes)
    if (!row.culled && row.kind != "readback") {
      if (row.name == t.wanted.pass) pass = int(passes.size());
      passes.push_back(row.name);
    }
  for (const live::GraphInfo::Resource& row : g.resources)
    if (!row.buffer && !row.imported && row.live) {
      if (row.name == t.wanted.resource) resource = int(resources.size());
      resources.push_back(row.name);
    }
  ImGui::SetNextItemWidth(-FLT_MIN);
  if (ui::combo("texture.resource", "", resource, resources)) {
    t.wanted.resource = resources[size_t(resource)];
    t.auto_range = true;
    // Where it is last used unless that pass is chosen already.
    for (const live::GraphInfo::Resource& row : g.resources)
      if (row.name == t.wanted.resource) t.wanted.pass = g.passes[row.last].name;
    while (std::find(passes.begin(), passes.end(), t.wanted.pass) == passes.end() && !passes.empty())
      t.wanted.pass = passes.back();
  }
  ui::tooltip("Which image of the frame; the graph panel's cells open one, too");
  int when = t.wanted.before ? 0 : 1;
  ImGui::SetNextItemWidth(ImGui::GetFontSize() * 5);
  if (ui::combo("texture.when", "", when, {"before", "after"})) t.wanted.before = when == 0;
  ImGui::SameLine();
  ImGui::SetNextItemWidth(-FLT_MIN);
  if (ui::combo("texture.pass", "", pass, passes)) t.wanted.pass = passes[size_t(pass)];
  for (const live::GraphInfo::Resource& row : g.resources) {
    if (row.name != t.wanted.resource) continue;
    ImGui::TextDisabled("%s %s, %u mip, %u layer", row.format.c_str(), row.size.c_str(), row.mips, row.layers);
    int mip = t.wanted.mip, layer = t.wanted.layer;
    if (row.mips > 1 && ui::slider_int("texture.mip", "mip", mip, 0, int(row.mips) - 1)) t.wanted.mip = uint8_t(mip);
    if (row.layers > 1 && ui::slider_int("texture.layer", "layer", layer, 0, int(row.layers) - 1))
      t.wanted.layer = uint8_t(layer);
  }
  ui::checkbox("texture.freeze", "freeze", t.frozen, "Keep this picture");
  ImGui::SameLine();
  {
    const ui::Disabled none(t.pixels.floats.empty());
    if (ui::button("texture.save_png", "save PNG", "As it is shown")) editor.save_texture = ".png";
    ImGui::SameLine();
    if (ui::button("texture.save_exr", "save EXR", "Its numbers")) editor.save_texture = ".exr";
  }
  if (!t.error.empty()) ImGui::TextWrapped("%s", t.error.c_str());
  if (t.pixels.floats.empty()) return;
  draw_look("texture", t.look, t.auto_range, true);
  if (t.auto_range) fit_range(t.pixels, t.look);
  const ImVec2 room = ImGui::GetContentRegionAvail();
  const float scale = std::min(room.x / float(t.pixels.size.x),
                               std::max(room.y - ImGui::GetFontSize() * 1.5f, 20.0f) / float(t.pixels.size.y));
  const ImVec2 size(std::max(float(t.pixels.size.x) * scale, 1.0f), std::max(float(t.pixels.size.y) * scale, 1.0f));
  ui::PictureLook look = t.look;
  look.nearest = scale >= 2;
  if (void* id = editor.pictures->show(ui::PictureId::Texture, look)) {
    const ImVec2 low = ImGui::GetCursorScreenPos();
    ImGui::Image(id, size);
    ui::note("texture.picture", t.pixels.name);
    if (ImGui::IsItemHovered()) {
      const ImVec2 mouse = ImGui::GetIO().MousePos;
      const glm::uvec2 at =
          glm::min(glm::uvec2(glm::max(glm::vec2((mouse.x - low.x) / size.x, (mouse.y - low.y) / size.y), 0.0f) *
                              glm::vec2(t.pixels.size)),
                   t.pixels.size - 1u);
      const float* v = &t.pixels.floats[(size_t(at.y) * t.pixels.size.x + at.x) * 4];
      ImGui::Text("%u, %u: %.5g %.5g %.5g %.5g", at.x, at.y, double(v[0]), double(v[1]), double(v[2]), double(v[3]));
    }
  }
}

}  // namespace nf::editor
