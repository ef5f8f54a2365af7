// One pixel's values in every layer and image, and any resource of the frame at any pass.
#include <algorithm>
#include <cmath>
#include <imgui.h>
#include <imgui_internal.h>
#include <nlohmann/json.hpp>

#include "look.h"
#include "panels/panels.h"
#include "pixel.h"
#include "ui/widgets.h"

namespace nf::editor {

namespace {

const ImVec4 wrong_color(1, 0.4f, 1, 1);

bool contains(const std::string& text, const std::string& part) {
  return std::search(text.begin(), text.end(), part.begin(), part.end()) != text.end();
}

bool finite(const std::vector<float>& values) {
  return std::all_of(values.begin(), values.end(), [](float x) { return std::isfinite(x); });
}

void draw_heading(const char* text) {
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  ImGui::TextDisabled("%s", text);
}

// Numbers beside each other while there is room: Dear ImGui's own wrapping breaks them at their points.
void draw_values(const std::string& text, bool good) {
  const float edge = ImGui::GetCursorScreenPos().x + ImGui::GetContentRegionAvail().x;
  for (size_t at = 0; at < text.size();) {
    const size_t end = std::min(text.find("  ", at), text.size());
    const std::string word = text.substr(at, end - at);
    const float gap = ImGui::GetFontSize() * 0.6f;
    if (at > 0 && ImGui::GetItemRectMax().x + gap + ImGui::CalcTextSize(word.c_str()).x <= edge)
      ImGui::SameLine(0, gap);
    if (good)
      ImGui::TextUnformatted(word.c_str());
    else
      ImGui::TextColored(wrong_color, "%s", word.c_str());
    at = end + 2;
  }
}

void draw_image_row(const live::ImageValue& image, glm::uvec2 picture) {
  const std::string title = title_of(image);
  std::string id = "pixel.image." + title;
  std::replace(id.begin(), id.end(), ' ', '_');  // conditions of scripts have none in a name
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  ImGui::TextUnformatted(title.c_str());
  ui::tooltip(
      fmt::format("{}: {}, {} x {}, as {} leaves it", title, image.format, image.size.x, image.size.y, image.pass));
  ImGui::TableNextColumn();
  if (!image.of_view) {
    ImGui::TextDisabled("seen from a light: no texel of it is this pixel's");
    ui::note(id, "another view");
    return;
  }
  const std::string text = text_of(image);
  draw_values(text, finite(image.values));
  ui::note(id, text);
  if (!image.meaning.empty()) {
    const std::string unpacked = image.unpacked.empty() ? "nothing" : text_of(image.unpacked);
    ImGui::TextDisabled("%s", image.meaning.c_str());
    draw_values(unpacked, finite(image.unpacked));
    ui::note(id + ".unpacked", unpacked);
  }
  if (image.size == picture) return;
  const std::string texel =
      fmt::format("texel {}, {} of {} x {}", image.texel.x, image.texel.y, image.size.x, image.size.y);
  ImGui::TextDisabled("%s", texel.c_str());
  ui::note(id + ".texel", texel);
}

}  // namespace

void draw_pixel_panel(Editor& editor) {
  Picking& p = editor.picking;
  editor.pixel_visible = true;
  if (!p.locked) {
    ImGui::TextWrapped(
        "Click into the picture, or Ctrl+G: every layer's value at that pixel stands here, and every image's of the "
        "frame.");
    return;
  }
  const live::Picked& values = p.values;
  ImGui::Text("pixel %u, %u of %u x %u", p.pixel.x, p.pixel.y, p.size.x, p.size.y);
  ui::note("pixel.place", fmt::format("{} {}", p.pixel.x, p.pixel.y));
  if (ui::button("pixel.again", "read again")) p.asked = true;
  ImGui::SameLine();
  if (ui::button("pixel.go_to", "go to ...",
                 "Another pixel by its numbers (Ctrl+G); the arrow keys go to the next one"))
    p.show_go_to = true;
  ImGui::SameLine();
  if (ui::button("pixel.copy", "copy JSON", "All values as JSON, with all their digits"))
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
  ImGui::SetNextItemWidth(-FLT_MIN);
  ui::text_input("pixel.search", "search names", p.search);
  if (!ImGui::BeginTable("layers", 2, ImGuiTableFlags_RowBg | ImGuiTableFlags_ScrollY | ImGuiTableFlags_Resizable))
    return;
  ImGui::TableSetupColumn("layer", ImGuiTableColumnFlags_WidthStretch, 0.42f);
  ImGui::TableSetupColumn("value", ImGuiTableColumnFlags_WidthStretch, 0.58f);
  draw_heading("layers, decoded");
  for (const live::LayerValue& layer : values.layers) {
    if (!contains(layer.name, p.search)) continue;
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(layer.name.c_str());
    ImGui::TableNextColumn();
    const std::string text = text_of(layer.values);
    draw_values(text, finite(layer.values));
    ui::note("pixel.layer." + layer.name, text);
  }
  draw_heading("images of the frame");
  ui::note("pixel.images", fmt::format("{}", values.images.size()));
  for (const live::ImageValue& image : values.images)
    if (contains(title_of(image), p.search)) draw_image_row(image, then.size);
  ImGui::EndTable();
}

void draw_go_to_pixel(Editor& editor) {
  Picking& p = editor.picking;
  if (!p.show_go_to) return;
  const Viewport& v = editor.viewport;
  const float line = ImGui::GetFontSize();
  ImGui::SetNextWindowPos(ImVec2(v.x + v.width / 2, v.y + line), ImGuiCond_Always, ImVec2(0.5f, 0));
  ImGui::SetNextWindowSize(ImVec2(line * 18, 0));
  if (ImGui::Begin("Go to pixel", &p.show_go_to,
                   ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoSavedSettings)) {
    if (ImGui::IsWindowAppearing()) {
      p.go_to_text.clear();
      p.go_to_fault.clear();
      ImGui::SetKeyboardFocusHere();
    }
    const glm::uvec2 size = editor.wanted.size;
    ImGui::SetNextItemWidth(-FLT_MIN);
    if (ui::text_input("pixel.go_to.place", fmt::format("x,y up to {},{}", size.x - 1, size.y - 1).c_str(),
                       p.go_to_text))
      p.go_to_fault.clear();
    if (ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Enter))) {
      glm::uvec2 pixel;
      p.go_to_fault = parse_pixel(p.go_to_text, size, pixel);
      if (p.go_to_fault.empty()) {
        p.place = (glm::vec2(pixel) + 0.5f) / glm::vec2(size);
        p.asked = p.locked = true;
        p.show_go_to = false;
        editor.preferences.right_tab = "Pixel";
      } else {
        ImGui::SetKeyboardFocusHere(-1);
      }
    }
    if (!p.go_to_fault.empty()) {
      ImGui::PushTextWrapPos(0);
      ImGui::TextColored(wrong_color, "%s", p.go_to_fault.c_str());
      ImGui::PopTextWrapPos();
      ui::note("pixel.go_to.fault", p.go_to_fault);
    }
  }
  ImGui::End();
}

namespace {

// The texture, all of it or a part: the wheel zooms where the pointer is, dragging moves it, a double click fits it.
void draw_texels(Editor& editor) {
  TextureView& t = editor.texture;
  const ImVec2 low = ImGui::GetCursorScreenPos(), room = ImGui::GetContentRegionAvail();
  const glm::vec2 texels(t.pixels.size),
      area(std::max(room.x, 1.0f), std::max(room.y - ImGui::GetFontSize() * 1.5f, 20.0f)),
      middle = glm::vec2(low.x, low.y) + area / 2.0f;
  const float fit = std::min(area.x / texels.x, area.y / texels.y);
  ImGui::InvisibleButton("texels", ImVec2(area.x, area.y));
  const ImGuiIO& io = ImGui::GetIO();
  const bool hovered = ImGui::IsItemHovered();
  const glm::vec2 mouse(io.MousePos.x, io.MousePos.y);
  if (hovered) ImGui::SetItemUsingMouseWheel();
  if (hovered && io.MouseWheel != 0) {
    const glm::vec2 under = t.centre + (mouse - middle) / (texels * fit * t.zoom);
    t.zoom = std::clamp(t.zoom * std::pow(1.25f, io.MouseWheel), 1.0f, std::max(64 / fit, 1.0f));
    t.centre = under - (mouse - middle) / (texels * fit * t.zoom);
  }
  if (ImGui::IsItemActive()) t.centre -= glm::vec2(io.MouseDelta.x, io.MouseDelta.y) / (texels * fit * t.zoom);
  if (hovered && ImGui::IsMouseDoubleClicked(0)) t.zoom = 1;
  const glm::vec2 extent = glm::max(texels * fit * t.zoom, 1.0f), half = glm::min(area / (2.0f * extent), 0.5f);
  t.centre = glm::clamp(t.centre, half, 1.0f - half);
  ui::PictureLook look = t.look;
  look.nearest = fit * t.zoom >= 2;
  void* id = editor.pictures->show(ui::PictureId::Texture, look);
  if (!id) return;
  // On whole pixels, so that each texel has its own.
  const glm::vec2 origin = glm::floor(middle - t.centre * extent), corner(low.x, low.y);
  const glm::vec2 seen_low = glm::max(origin, corner), seen_high = glm::min(origin + extent, corner + area);
  const glm::vec2 first = (seen_low - origin) / extent, last = (seen_high - origin) / extent;
  ImGui::GetWindowDrawList()->AddImage(id, ImVec2(seen_low.x, seen_low.y), ImVec2(seen_high.x, seen_high.y),
                                       ImVec2(first.x, first.y), ImVec2(last.x, last.y));
  const glm::vec2 seen = seen_high - seen_low;
  ui::note_area("texture.picture", seen_low.x, seen_low.y, seen.x, seen.y, t.pixels.name);
  std::string text = fmt::format("{:.3g} pixels a texel", fit * t.zoom);
  const glm::vec2 at = (mouse - origin) / extent;
  if (hovered && glm::all(glm::greaterThanEqual(at, glm::vec2(0))) && glm::all(glm::lessThan(at, glm::vec2(1)))) {
    const glm::uvec2 texel = glm::min(glm::uvec2(at * texels), t.pixels.size - 1u);
    const float* v = &t.pixels.floats[(size_t(texel.y) * t.pixels.size.x + texel.x) * 4];
    text = fmt::format("{}, {}: {}", texel.x, texel.y,
                       text_of(std::vector<float>(v, v + std::min(t.pixels.channels, 4u))));
  }
  ImGui::TextUnformatted(text.c_str());
  ui::note("texture.under", text);
  ui::note_area("texture.zoom", seen_low.x, seen_low.y, seen.x, seen.y, fmt::format("{:.4g}", t.zoom));
}

}  // namespace

void draw_texture_panel(Editor& editor) {
  TextureView& t = editor.texture;
  editor.texture_visible = true;
  const live::GraphInfo& g = editor.graph;
  std::vector<std::string> passes, resources;
  int pass = -1, resource = -1;
  for (const live::GraphInfo::Pass& row : g.passes)
    if (!row.culled && row.kind != "readback") {
      if (row.label == t.wanted.pass) pass = int(passes.size());
      passes.push_back(row.label);
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
    t.zoom = 1;
    // Where it is last used unless that pass is chosen already.
    for (const live::GraphInfo::Resource& row : g.resources)
      if (row.name == t.wanted.resource) t.wanted.pass = g.passes[row.last].label;
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
  choose_channels(t.pixels, t.look);
  draw_look("texture", t.pixels, t.look, t.auto_range);
  if (t.auto_range) fit_range(t.pixels, t.look);
  draw_texels(editor);
}

}  // namespace nf::editor
