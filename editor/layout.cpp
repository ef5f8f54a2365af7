#include "layout.h"

#include <algorithm>
#include <filesystem>
#include <imgui.h>

#include "actions.h"
#include "panels/panels.h"
#include "ui/widgets.h"

namespace nf::editor {
namespace {

constexpr ImGuiWindowFlags fixed = ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoCollapse |
                                   ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoSavedSettings |
                                   ImGuiWindowFlags_NoBringToFrontOnFocus;

struct Tab {
  const char* name;
  void (*draw)(Editor&);
};
constexpr const char* floating_id = "##floating";
constexpr Tab right_tabs[] = {{"Pixel", draw_pixel_panel},
                              {"Slices", draw_slices_panel},
                              {"Texture", draw_texture_panel},
                              {"Scene", draw_scene_panel},
                              {"Reference", draw_reference_panel}};
constexpr Tab bottom_tabs[] = {{"Timings", draw_timings_panel},
                               {"Graph", draw_graph_panel},
                               {"Memory", draw_memory_panel},
                               {"Log", draw_log_panel}};

// A double click on the tab, or pulling it away from its bar.
bool is_taken_out() {
  if (ImGui::IsItemHovered() && ImGui::IsMouseDoubleClicked(0)) return true;
  const float low = ImGui::GetItemRectMin().y, high = ImGui::GetItemRectMax().y, y = ImGui::GetIO().MousePos.y;
  const float far = 1.5f * (high - low);
  return ImGui::IsItemActive() && ImGui::IsMouseDragging(0) && (y < low - far || y > high + far);
}

void take_out(Editor& editor, const char* name) {
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  const float line = ImGui::GetFontSize();
  const float width = std::min(line * 34, float(editor.window.x) * 0.6f),
              height = std::min(line * 26, float(editor.window.y) * 0.6f);
  editor.preferences.floating[name] = {mouse.x - line * 4, mouse.y - line * 0.6f, width, height};
  editor.carried = name;
}

// `wanted` names a tab to switch to, and is then forgotten; the tab that is open is `now`.
void draw_tabs(Editor& editor, const char* bar, std::span<const Tab> tabs, std::string& wanted, std::string& now) {
  for (const Tab& tab : tabs) {
    const bool asked = wanted == tab.name;
    if (editor.preferences.floating.count(tab.name)) {
      if (asked) ImGui::SetWindowFocus((std::string(tab.name) + floating_id).c_str());
      if (asked) wanted.clear();
      continue;
    }
    const bool open = ImGui::BeginTabItem(tab.name, nullptr, asked ? ImGuiTabItemFlags_SetSelected : 0);
    ui::note(std::string(bar) + "." + tab.name, open ? "open" : "closed");
    if (asked) wanted.clear();
    if (is_taken_out()) take_out(editor, tab.name);
    ui::tooltip("Double click, or pull away: a window of its own");
    if (!open) continue;
    now = tab.name;
    tab.draw(editor);
    ImGui::EndTabItem();
  }
}

// A panel in a window of its own, within this one. Its close button puts it back among the tabs.
void draw_floating(Editor& editor, const Tab& tab) {
  const auto found = editor.preferences.floating.find(tab.name);
  if (found == editor.preferences.floating.end()) return;
  Floating& f = found->second;
  const float line = ImGui::GetFontSize(), title = ImGui::GetFrameHeight();
  const bool carried = editor.carried == tab.name;
  if (carried) {
    const ImVec2 mouse = ImGui::GetIO().MousePos;
    f.x = std::clamp(mouse.x - line * 4, 0.0f, std::max(float(editor.window.x) - f.width, 0.0f));
    f.y = std::clamp(mouse.y - title / 2, 0.0f, std::max(float(editor.window.y) - f.height, 0.0f));
    if (!ImGui::IsMouseDown(0)) editor.carried.clear();
  }
  ImGui::SetNextWindowPos(ImVec2(f.x, f.y), carried ? ImGuiCond_Always : ImGuiCond_Appearing);
  ImGui::SetNextWindowSize(ImVec2(f.width, f.height), ImGuiCond_Appearing);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, 1);
  bool open = true;
  const bool visible = ImGui::Begin((std::string(tab.name) + floating_id).c_str(), &open,
                                    ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoSavedSettings);
  ImGui::PopStyleVar();
  // Where the user's hand has moved it to in this frame; its title can always be reached.
  const ImVec2 size = ImGui::GetWindowSize();
  ImVec2 at = ImGui::GetWindowPos();
  at.x = std::clamp(at.x, line * 4 - size.x, std::max(float(editor.window.x) - line * 4, line * 4 - size.x));
  at.y = std::clamp(at.y, 0.0f, std::max(float(editor.window.y) - title, 0.0f));
  ImGui::SetWindowPos(at);
  f = {at.x, at.y, size.x, size.y};
  const std::string id = std::string("floating.") + tab.name;
  ui::note_area(id, at.x, at.y, size.x - title, title,
                fmt::format("{:.0f} {:.0f} {:.0f} {:.0f}", f.x, f.y, f.width, f.height));
  ui::note_area(id + ".close", at.x + size.x - title, at.y, title, title);
  ui::note_area(id + ".grip", at.x + size.x - line * 0.6f, at.y + size.y - line * 0.6f, line * 0.5f, line * 0.5f);
  if (visible) tab.draw(editor);
  ImGui::End();
  if (!open) editor.preferences.floating.erase(found);
}

void draw_menu(Editor& editor) {
  if (!ImGui::BeginMainMenuBar()) return;
  for (const char* menu : {"File", "Edit", "View", "Technique", "Capture", "Help"}) {
    const bool open = ImGui::BeginMenu(menu);
    ui::note(std::string("menu.") + menu, open ? "open" : "closed");
    if (!open) continue;
    for (const Action& action : actions()) {
      if (std::string_view(action.menu) != menu) continue;
      const std::string keys = *action.keys ? ui::chord_name(ui::parse_chord(action.keys)) : "";
      if (ImGui::MenuItem(action.name, keys.c_str())) action.run(editor);
      ui::note(std::string("menu.") + action.id);
      ui::tooltip(action.help);
    }
    if (std::string_view(menu) == "View") {
      ImGui::Separator();
      Preferences& p = editor.preferences;
      int percent = int(p.render_scale * 100 + 0.5f);
      ImGui::SetNextItemWidth(ImGui::GetFontSize() * 8);
      if (ui::slider_int("view.render_scale", "render scale %", percent, 25, 100))
        p.render_scale = float(percent) / 100, p.scale_chosen = true;
      int moving = int(p.moving_scale * 100 + 0.5f);
      ImGui::SetNextItemWidth(ImGui::GetFontSize() * 8);
      if (ui::slider_int("view.moving_scale", "while moving %", moving, 10, 100)) p.moving_scale = float(moving) / 100;
      ImGui::SetNextItemWidth(ImGui::GetFontSize() * 8);
      ui::slider_int("view.settle", "frames until still", p.settle, 1, 1024);
    }
    ImGui::EndMenu();
  }
  ImGui::TextDisabled("|");
  ImGui::Text("%s  %s", std::filesystem::path(editor.scene.path).filename().string().c_str(),
              editor.document.settings.technique->id);
  ImGui::TextDisabled("%u x %u", editor.picture.size.x, editor.picture.size.y);
  if (editor.scene_ms > 0) ImGui::Text("%.1f ms", double(editor.scene_ms));
  ui::note("status.ms", fmt::format("{:.2f}", editor.scene_ms));
  if (editor.software) {
    ui::chip("status.software",
             fmt::format("software Vulkan, scale {:.0f} %", double(editor.preferences.render_scale * 100)),
             IM_COL32(240, 200, 90, 255));
    ui::tooltip("The device is a CPU: times are CPU times. View > render scale changes the scale.");
  }
  ImGui::EndMainMenuBar();
}

// A bar that drags a share of `length` pixels.
void splitter(const char* id, ImVec2 low, ImVec2 size, float& share, float sign, float length) {
  ImGui::SetNextWindowPos(low);
  ImGui::SetNextWindowSize(size);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(0, 0));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, ImVec2(1, 1));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, 0);
  ImGui::Begin(id, nullptr, fixed | ImGuiWindowFlags_NoBackground | ImGuiWindowFlags_NoScrollbar);
  ImGui::InvisibleButton("bar", size);
  ui::note(id, fmt::format("{:.4f}", share));
  if (ImGui::IsItemHovered() || ImGui::IsItemActive()) {
    ImGui::SetMouseCursor(size.x < size.y ? ImGuiMouseCursor_ResizeEW : ImGuiMouseCursor_ResizeNS);
    ImGui::GetWindowDrawList()->AddRectFilled(low, ImVec2(low.x + size.x, low.y + size.y),
                                              IM_COL32(120, 190, 255, 160));
  }
  if (ImGui::IsItemActive()) {
    const ImVec2 d = ImGui::GetIO().MouseDelta;
    share = std::clamp(share + sign * (size.x < size.y ? d.x : d.y) / std::max(length, 1.0f), 0.08f, 0.6f);
  }
  ImGui::End();
  ImGui::PopStyleVar(3);
}

void begin_region(const char* name, float x, float y, float width, float height) {
  ImGui::SetNextWindowPos(ImVec2(x, y));
  ImGui::SetNextWindowSize(ImVec2(std::max(width, 1.0f), std::max(height, 1.0f)));
  ImGui::Begin(name, nullptr, fixed);
  ui::note_area(std::string("region.") + name, x, y, width, height);
}

void draw_status(Editor& editor, float y, float height) {
  ImGui::SetNextWindowPos(ImVec2(0, y));
  ImGui::SetNextWindowSize(ImVec2(float(editor.window.x), height));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(6, 1));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, ImVec2(1, 1));
  ImGui::Begin("status", nullptr, fixed | ImGuiWindowFlags_NoScrollbar | ImGuiWindowFlags_NoInputs);
  const glm::vec2 c = editor.viewport.cursor;
  if (c.x >= 0 && editor.picture.size.x > 0) {
    const glm::uvec2 p = glm::min(glm::uvec2(c * glm::vec2(editor.picture.size)), editor.picture.size - 1u);
    if (!editor.picture.floats.empty()) {
      const float* v = &editor.picture.floats[(size_t(p.y) * editor.picture.size.x + p.x) * 4];
      ImGui::Text("%u, %u  %.4g %.4g %.4g  |", p.x, p.y, double(v[0]), double(v[1]), double(v[2]));
    } else if (const std::optional<glm::u8vec4> v = editor.pictures->texel(ui::PictureId::Scene, p)) {
      ImGui::Text("%u, %u  rgb %u %u %u  |", p.x, p.y, v->x, v->y, v->z);
    } else {
      ImGui::Text("%u, %u  |", p.x, p.y);
    }
    ImGui::SameLine();
  }
  const double fps = editor.scene_ms > 0 ? 1000.0 / double(editor.scene_ms) : 0;
  ImGui::Text("UI %.1f ms  |  scene %.1f fps  |  frame %u of %u  |  seed %u  |  %s  |  F1 help", double(editor.ui_ms),
              fps, std::min(editor.settled, editor.wanted.settle), editor.wanted.settle, editor.document.seed,
              editor.device.c_str());
  ImGui::End();
  ImGui::PopStyleVar(2);
}

void draw_toasts(Editor& editor) {
  std::erase_if(editor.toasts, [&](const Toast& t) { return t.until < editor.now; });
  ImDrawList* list = ImGui::GetForegroundDrawList();
  float y = float(editor.window.y) - ImGui::GetFontSize() * 2.6f;
  for (auto t = editor.toasts.rbegin(); t != editor.toasts.rend(); ++t) {
    const float wrap = std::min(ImGui::GetFontSize() * 30, float(editor.window.x) * 0.8f);
    const ImVec2 size = ImGui::CalcTextSize(t->text.c_str(), nullptr, false, wrap);
    y -= size.y + 14;
    const float x = float(editor.window.x) - size.x - 24;
    list->AddRectFilled(ImVec2(x - 8, y - 5), ImVec2(x + size.x + 8, y + size.y + 5),
                        t->bad ? IM_COL32(130, 30, 30, 240) : IM_COL32(45, 60, 80, 240), 4);
    list->AddText(nullptr, 0, ImVec2(x, y), IM_COL32(255, 255, 255, 255), t->text.c_str(), nullptr, wrap);
  }
}

void draw_hints(Editor& editor) {
  if (!editor.preferences.hints || editor.scene_frames == 0 || !editor.banner.text.empty()) return;
  const Viewport& v = editor.viewport;
  const float line = ImGui::GetFontSize();
  ImGui::SetNextWindowPos(ImVec2(v.x + v.width - line, v.y + line), ImGuiCond_Always, ImVec2(1, 0));
  ImGui::SetNextWindowBgAlpha(0.85f);
  ImGui::Begin("hints", nullptr, (fixed & ~ImGuiWindowFlags_NoBringToFrontOnFocus) | ImGuiWindowFlags_AlwaysAutoResize);
  ImGui::TextUnformatted(
      "right drag and W A S D: fly        N: next technique\nK, then X: wipe against this picture   F1: all keys");
  if (ui::button("hints.dismiss", "Got it")) editor.preferences.hints = false;
  ImGui::End();
}

// What a capture has so far, and where it lies, until somebody has read it.
void draw_captured(Editor& editor) {
  if (!editor.recording && editor.captured.empty()) return;
  const Viewport& v = editor.viewport;
  const float line = ImGui::GetFontSize();
  ImGui::SetNextWindowPos(ImVec2(v.x + line, v.y + line), ImGuiCond_Always);
  ImGui::SetNextWindowBgAlpha(0.9f);
  ImGui::Begin("captured", nullptr,
               (fixed & ~ImGuiWindowFlags_NoBringToFrontOnFocus) | ImGuiWindowFlags_AlwaysAutoResize);
  if (editor.recording) {
    const std::string text =
        fmt::format("recording: {} of {} frames", editor.timings.run.frames.size(), editor.preferences.capture_frames);
    ImGui::TextUnformatted(text.c_str());
    ui::note("captured.recording", text);
    ImGui::SameLine();
    if (ui::button("captured.stop", "Stop and write")) editor.capture_asked = true;
  } else {
    ImGui::PushTextWrapPos(std::max(v.width - 4 * line, 8 * line));
    ImGui::Text("timings written to %s", editor.captured.c_str());
    ImGui::PopTextWrapPos();
    ui::note("captured.folder", editor.captured);
    if (ui::button("captured.copy", "Copy path")) {
      ImGui::SetClipboardText(editor.captured.c_str());
      toast(editor, "copied: " + editor.captured);
    }
    ImGui::SameLine();
    if (ui::button("captured.close", "Close")) editor.captured.clear();
  }
  ImGui::End();
}

}  // namespace

void draw_layout(Editor& editor) {
  const float width = float(editor.window.x), height = float(editor.window.y), line = ImGui::GetFontSize();
  Preferences& p = editor.preferences;
  if (p.hide_ui) {
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(0, 0));
    begin_region("viewport", 0, 0, width, height);
    ImGui::PopStyleVar();
    draw_viewport(editor);
    ImGui::End();
    draw_help(editor);
    draw_dialogs(editor);
    draw_go_to_pixel(editor);
    draw_toasts(editor);
    return;
  }
  draw_menu(editor);
  const float top = ImGui::GetFrameHeight(), status = line * 1.5f, gap = 4 * std::max(editor.scale(), 1.0f);
  const float room = std::max(height - top - status, 1.0f);
  // Narrow windows: the right region's tabs stand at the bottom.
  const bool narrow = width < 1100 * editor.scale();
  const float left = std::floor(width * p.left), right = narrow ? 0 : std::floor(width * p.right),
              bottom = std::floor(room * p.bottom);
  const float middle = std::max(width - left - right - gap * (narrow ? 1 : 2), 1.0f),
              upper = std::max(room - bottom - gap, 1.0f);

  begin_region("technique", 0, top, left, upper);
  draw_technique_panel(editor);
  ImGui::End();
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(4, 4));
  begin_region("viewport", left + gap, top, middle, upper);
  ImGui::PopStyleVar();
  draw_viewport(editor);
  ImGui::End();
  if (!narrow) {
    begin_region("inspector", width - right, top, right, upper);
    if (ImGui::BeginTabBar("inspector")) {
      draw_tabs(editor, "inspector", right_tabs, p.right_tab, p.right_open);
      ImGui::EndTabBar();
    }
    ImGui::End();
  }
  begin_region("bottom", 0, top + upper + gap, width, bottom);
  if (ImGui::BeginTabBar("bottom")) {
    draw_tabs(editor, "bottom", bottom_tabs, p.bottom_tab, p.bottom_open);
    if (narrow) draw_tabs(editor, "inspector", right_tabs, p.right_tab, p.right_open);
    ImGui::EndTabBar();
  }
  ImGui::End();
  splitter("splitter.left", ImVec2(left, top), ImVec2(gap, upper), p.left, 1, width);
  if (!narrow) splitter("splitter.right", ImVec2(width - right - gap, top), ImVec2(gap, upper), p.right, -1, width);
  splitter("splitter.bottom", ImVec2(0, top + upper), ImVec2(width, gap), p.bottom, -1, room);
  for (const Tab& tab : right_tabs) draw_floating(editor, tab);
  for (const Tab& tab : bottom_tabs) draw_floating(editor, tab);
  draw_status(editor, height - status, status);
  draw_hints(editor);
  draw_captured(editor);
  draw_help(editor);
  draw_dialogs(editor);
  draw_go_to_pixel(editor);
  draw_toasts(editor);
}

void apply_theme(float scale) {
  ImGuiStyle& style = ImGui::GetStyle();
  style = ImGuiStyle();
  ImGui::StyleColorsDark();
  style.WindowRounding = 0;
  style.FrameRounding = 3;
  style.GrabRounding = 3;
  style.WindowBorderSize = 0;
  style.TabRounding = 3;
  style.ItemSpacing = ImVec2(6, 4);
  style.WindowPadding = ImVec2(6, 6);
  style.Colors[ImGuiCol_WindowBg] = ImVec4(0.11f, 0.11f, 0.125f, 1);
  style.Colors[ImGuiCol_PopupBg] = ImVec4(0.13f, 0.13f, 0.15f, 0.98f);
  style.Colors[ImGuiCol_Text] = ImVec4(0.92f, 0.92f, 0.92f, 1);
  style.Colors[ImGuiCol_TextDisabled] = ImVec4(0.62f, 0.62f, 0.64f, 1);
  style.ScaleAllSizes(scale);
}

}  // namespace nf::editor
