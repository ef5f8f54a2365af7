// The picture: what is shown, the camera, the pixel under the cursor, what failed.
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <algorithm>
#include <cmath>
#include <imgui.h>

#include "actions.h"
#include "camera.h"
#include "look.h"
#include "panels/panels.h"
#include "settings.h"
#include "ui/widgets.h"

namespace nf::editor {
namespace {

ImVec2 operator+(ImVec2 a, ImVec2 b) {
  return {a.x + b.x, a.y + b.y};
}

void draw_toolbar(Editor& editor) {
  Viewport& v = editor.viewport;
  std::vector<std::string> layers;
  int index = 0;
  for (const passes::Aov& aov : passes::aovs()) {
    if (v.layer == aov.name) index = int(layers.size());
    layers.push_back(*aov.name ? aov.name : "picture");
  }
  ImGui::SetNextItemWidth(ImGui::GetFontSize() * 9);
  if (ui::combo("viewport.layer", "", index, layers)) {
    v.layer = passes::aovs()[size_t(index)].name;
    v.auto_range = true;
  }
  ui::tooltip(std::string("What is shown: ") + passes::aovs()[size_t(index)].help);
  ImGui::SameLine();
  draw_compare_tools(editor);
}

// RMB: look, with WASDQE fly; Alt+LMB: orbit; MMB: pan; wheel: dolly.
void control_camera(Editor& editor, bool active) {
  CameraControl& c = editor.view;
  ImGuiIO& io = ImGui::GetIO();
  const auto held = [&](int key) { return editor.input && editor.input->held(key) ? 1.0f : 0.0f; };
  const bool looking = active && ImGui::IsMouseDown(1), panning = active && ImGui::IsMouseDown(2);
  const bool orbiting = active && ImGui::IsMouseDown(0) && io.KeyAlt;
  const glm::vec2 by(io.MouseDelta.x, io.MouseDelta.y);
  const bool moved = by != glm::vec2(0);
  if (looking && moved) look_around(c, -by.x * 0.004f, -by.y * 0.004f);
  if (looking) {
    const Flight keys{.ahead = held(GLFW_KEY_W) - held(GLFW_KEY_S),
                      .right = held(GLFW_KEY_D) - held(GLFW_KEY_A),
                      .up = held(GLFW_KEY_E) - held(GLFW_KEY_Q),
                      .fast = io.KeyShift,
                      .slow = io.KeyCtrl};
    fly(c, keys, std::min(io.DeltaTime, 0.1f));
    if (io.MouseWheel != 0) c.speed = std::clamp(c.speed * std::pow(1.2f, io.MouseWheel), 0.01f, 1000.0f);
  } else if (editor.viewport.hovered && io.MouseWheel != 0) {
    c.camera.position = c.target + (c.camera.position - c.target) * std::pow(0.85f, io.MouseWheel);
    c.moved = true;
  }
  if (orbiting && moved) orbit(c, orbit_pivot(editor), -by.x * 0.006f, -by.y * 0.006f);
  if (panning && moved) pan(c, by, editor.viewport.height);
}

void draw_picture(Editor& editor, ImVec2 low, ImVec2 size) {
  Viewport& v = editor.viewport;
  ImDrawList* list = ImGui::GetWindowDrawList();
  const ImVec2 high = low + size;
  const bool floats = !editor.picture.floats.empty();
  choose_channels(editor.picture, v.look);
  if (floats && v.auto_range) fit_range(editor.picture, v.look);
  ui::PictureLook look = v.look;
  look.nearest = size.x >= 2 * float(std::max(editor.picture.size.x, 1u));
  void* scene = editor.pictures->show(ui::PictureId::Scene, floats ? look : ui::PictureLook{.nearest = look.nearest});
  if (!scene) {
    const char* text = editor.device_lost          ? "the picture was lost with the device"
                       : editor.scene.path.empty() ? "no scene: drop a .glb or .gltf, or Ctrl+O"
                                                   : "the first picture is on its way ...";
    const ImVec2 extent = ImGui::CalcTextSize(text);
    list->AddRectFilled(low, high, IM_COL32(30, 30, 34, 255));
    list->AddText(ImVec2(low.x + (size.x - extent.x) / 2, low.y + (size.y - extent.y) / 2),
                  IM_COL32(190, 190, 190, 255), text);
    return;
  }
  draw_compared(editor, low.x, low.y, size.x, size.y, scene, floats ? look : ui::PictureLook{.nearest = look.nearest});
}

// What is pointed at, or what was clicked: its shape is kept. False: there is none.
bool draw_preview(Editor& editor, ImVec2 low, ImVec2 size) {
  const Preview* preview = preview_of(editor);
  if (!preview) return false;
  const auto title = [&](const std::string& text) {
    const ImVec2 words = ImGui::CalcTextSize(text.c_str());
    ImDrawList* list = ImGui::GetWindowDrawList();
    list->AddRectFilled(ImVec2(low.x + 4, low.y + 4), ImVec2(low.x + words.x + 14, low.y + words.y + 10),
                        IM_COL32(0, 0, 0, 190), 3);
    list->AddText(ImVec2(low.x + 9, low.y + 7), IM_COL32(255, 255, 255, 255), text.c_str());
  };
  if (preview->probe && (editor.fetched.of != *preview->probe || editor.fetched.pixels.floats.empty())) {
    // The scene meanwhile: it is there soon.
    const bool failed = editor.fetched.of == *preview->probe && !editor.fetched.error.empty();
    draw_picture(editor, low, size);
    title(preview->title + ": " + (failed ? editor.fetched.error : "on its way ..."));
    return true;
  }
  const glm::uvec2 texels = editor.pictures->size_of(preview->id);
  if (texels.x == 0 || texels.y == 0) return false;
  const float scale = std::min(size.x / float(texels.x), size.y / float(texels.y));
  ui::PictureLook look = preview->look;
  if (preview->probe) {
    choose_channels(editor.fetched.pixels, look);
    fit_range(editor.fetched.pixels, look);
  }
  look.nearest = scale >= 2;
  void* picture = editor.pictures->show(preview->id, look);
  if (!picture) return false;
  ImDrawList* list = ImGui::GetWindowDrawList();
  const ImVec2 extent(float(texels.x) * scale, float(texels.y) * scale);
  const ImVec2 at(low.x + (size.x - extent.x) / 2, low.y + (size.y - extent.y) / 2);
  list->AddRectFilled(low, low + size, IM_COL32(20, 20, 24, 255));
  list->AddImage(picture, at, at + extent);
  std::string text = preview->title;
  if (preview->probe) text += fmt::format("   {:.4g} to {:.4g}", look.low, look.high);
  title(text + (editor.shown_preview ? "" : "   (Esc: back to the scene)"));
  ui::note_area("viewport.preview", at.x, at.y, extent.x, extent.y, preview->title);
  return true;
}

void draw_overlay(Editor& editor, ImVec2 low, ImVec2 size) {
  ImDrawList* list = ImGui::GetWindowDrawList();
  const float line = ImGui::GetFontSize();
  const auto label = [&](ImVec2 at, ImU32 color, const std::string& text) {
    const ImVec2 extent = ImGui::CalcTextSize(text.c_str());
    list->AddRectFilled(ImVec2(at.x - 4, at.y - 2), ImVec2(at.x + extent.x + 4, at.y + extent.y + 2),
                        IM_COL32(0, 0, 0, 150), 3);
    list->AddText(at, color, text.c_str());
  };
  if (editor.scene_frames > 0 && !editor.preferences.hide_ui) {
    const glm::uvec2 s = editor.picture.size;
    std::string text = fmt::format("{} x {} > {:.0f} x {:.0f}", s.x, s.y, size.x, size.y);
    if (!editor.picture.name.empty()) text = editor.picture.name + "  " + text;
    if (!editor.picture.note.empty()) text += "  " + editor.picture.note;
    label(ImVec2(low.x + 8, low.y + size.y - line * 1.5f), IM_COL32(220, 220, 220, 255), text);
    if (editor.settled < editor.wanted.settle && !editor.wanted.paused) {
      const float share = float(editor.settled) / float(std::max(editor.wanted.settle, 1u));
      list->AddRectFilled(ImVec2(low.x, low.y + size.y - 2), ImVec2(low.x + size.x * share, low.y + size.y),
                          IM_COL32(120, 190, 255, 200));
    }
  }
  if (editor.wanted.paused) label(ImVec2(low.x + 8, low.y + 8), IM_COL32(255, 220, 120, 255), "frozen (Ctrl+Space)");
  if (editor.freeze.any() && !editor.wanted.paused) {
    const std::string text = "frozen: " + text_of(editor.freeze);
    label(ImVec2(low.x + 8, low.y + 8), IM_COL32(255, 220, 120, 255), text);
    ui::note_area("viewport.frozen", low.x + 8, low.y + 8, ImGui::CalcTextSize(text.c_str()).x, line, text);
  }
  for (size_t i = 0; i < editor.not_finite.size(); ++i)
    label(ImVec2(low.x + 8, low.y + 8 + line * 1.4f * float(i + 1)), IM_COL32(255, 130, 255, 255),
          editor.not_finite[i]);
  if (editor.picking.locked && editor.picture.size.x > 0) {
    const glm::vec2 at = editor.picking.place;
    const ImVec2 p(low.x + at.x * size.x, low.y + at.y * size.y);
    list->AddCircle(p, line * 0.5f, IM_COL32(0, 0, 0, 255), 0, 3);
    list->AddCircle(p, line * 0.5f, IM_COL32(255, 255, 255, 255), 0, 1.5f);
  }
}

void draw_banner(Editor& editor, ImVec2 low, ImVec2 size) {
  if (editor.banner.text.empty()) {
    const double left = 1.5 - (editor.now - editor.green_flash);
    if (left <= 0) return;
    ImDrawList* list = ImGui::GetWindowDrawList();
    list->AddRectFilled(low, ImVec2(low.x + size.x, low.y + ImGui::GetFontSize() * 1.6f),
                        IM_COL32(40, 140, 70, int(255 * std::min(left, 1.0))));
    list->AddText(ImVec2(low.x + 8, low.y + 3), IM_COL32(255, 255, 255, 255), editor.flash_text.c_str());
    return;
  }
  ImGui::SetCursorScreenPos(low);
  ImGui::PushStyleColor(ImGuiCol_ChildBg, ImVec4(0.42f, 0.07f, 0.07f, 0.94f));
  const float height =
      ImGui::GetTextLineHeightWithSpacing() * (2.6f + 3.2f * float(std::min<size_t>(editor.banner.faults.size(), 5)));
  ImGui::BeginChild("banner",
                    ImVec2(size.x, std::min(height + ImGui::GetTextLineHeightWithSpacing() * 2, size.y * 0.7f)), true);
  ImGui::PushTextWrapPos(0);
  ImGui::TextUnformatted(editor.banner.text.c_str());
  size_t shown = 0;
  for (const gpu::ReloadError& fault : editor.banner.faults) {
    if (++shown > 5) break;
    ImGui::TextUnformatted(fmt::format("{}:{}:{}: {}", fault.file, fault.line, fault.column, fault.message).c_str());
    if (!fault.source_line.empty()) ImGui::TextDisabled("    %s", fault.source_line.c_str());
  }
  ImGui::PopTextWrapPos();
  if (ui::button("banner.copy", "Copy")) {
    std::string text = editor.banner.text + "\n";
    for (const gpu::ReloadError& fault : editor.banner.faults)
      text += fmt::format("{}:{}:{}: {}\n", fault.file, fault.line, fault.column, fault.message);
    ImGui::SetClipboardText(text.c_str());
  }
  if (editor.device_lost) {
    ImGui::SameLine();
    if (ui::button("banner.restart", "Restart renderer"))
      editor.outbox.push_back({live::CommandKind::Restart, {}, {}, {}});
  } else {
    ImGui::SameLine();
    if (ui::button("banner.dismiss", "Dismiss")) editor.banner = {};
  }
  ImGui::EndChild();
  ImGui::PopStyleColor();
}

}  // namespace

void draw_viewport(Editor& editor) {
  Viewport& v = editor.viewport;
  if (!editor.preferences.hide_ui) draw_toolbar(editor);
  if (!editor.preferences.hide_ui && !editor.picture.floats.empty())
    draw_look("viewport", editor.picture, v.look, v.auto_range);
  ImVec2 low = ImGui::GetCursorScreenPos(), size = ImGui::GetContentRegionAvail();
  size = ImVec2(std::max(std::floor(size.x), 1.0f), std::max(std::floor(size.y), 1.0f));
  v.x = low.x, v.y = low.y, v.width = size.x, v.height = size.y;

  ImGui::InvisibleButton(
      "picture", size,
      ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight | ImGuiButtonFlags_MouseButtonMiddle);
  ui::note("viewport.picture", v.layer.empty() ? "picture" : v.layer);
  v.hovered = ImGui::IsItemHovered();
  const bool active = ImGui::IsItemActive();
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  v.cursor = v.hovered || active ? glm::vec2((mouse.x - low.x) / size.x, (mouse.y - low.y) / size.y) : glm::vec2(-1);

  if (v.compare == CompareMode::Wipe) {
    const bool near_line = v.hovered && std::abs(mouse.x - (low.x + size.x * v.wipe)) <= 6 * editor.scale();
    if (near_line || v.dragging_wipe) ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);
    if (near_line && ImGui::IsMouseClicked(0)) v.dragging_wipe = true;
    if (near_line && ImGui::IsMouseDoubleClicked(0)) v.wipe = 0.5f;
    if (!ImGui::IsMouseDown(0)) v.dragging_wipe = false;
    if (v.dragging_wipe) v.wipe = std::clamp(v.cursor.x, 0.0f, 1.0f);
    ui::note_area("viewport.wipe", low.x + size.x * v.wipe - 5, low.y, 10, size.y, fmt::format("{:.3f}", v.wipe));
  }
  const bool click = v.hovered && ImGui::IsMouseClicked(0) && !ImGui::GetIO().KeyAlt && !v.dragging_wipe;
  if (click && editor.picture.size.x > 0) {
    editor.picking.place = glm::clamp(v.cursor, 0.0f, 1.0f);
    editor.picking.asked = editor.picking.locked = true;
  }
  control_camera(editor, active);
  if (!draw_preview(editor, low, size)) {
    draw_picture(editor, low, size);
    draw_overlay(editor, low, size);
    draw_samples(editor, low.x, low.y, size.x, size.y);
  }
  draw_banner(editor, low, size);
}

}  // namespace nf::editor
