// The picture: what is shown, the camera, the pixel under the cursor, and A against B.
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <algorithm>
#include <cmath>
#include <imgui.h>

#include "actions.h"
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
  int mode = int(v.compare);
  ImGui::SetNextItemWidth(ImGui::GetFontSize() * 7);
  if (ui::combo("viewport.compare", "", mode, {"no compare", "wipe", "blink", "difference"}))
    v.compare = CompareMode(mode);
  ui::tooltip("Against the picture that Set A kept, or the reference (X wipe, B blink, H difference)");
  ImGui::SameLine();
  if (ui::button("viewport.set_a", "Set A", "Keep this picture to compare with")) {
    keep_as_a(editor);
  }
  if (v.compare != CompareMode::Off) {
    ImGui::SameLine();
    int against = v.against == ui::PictureId::SlotA ? 0 : 1;
    ImGui::SetNextItemWidth(ImGui::GetFontSize() * 6);
    if (ui::combo("viewport.against", "", against, {"A", "reference"}))
      v.against = against == 0 ? ui::PictureId::SlotA : ui::PictureId::Reference;
  }
  if (v.compare == CompareMode::Difference) {
    ImGui::SameLine();
    ImGui::SetNextItemWidth(ImGui::GetFontSize() * 6);
    std::vector<std::string> names;
    for (const DifferenceLook& row : differences) names.emplace_back(row.name);
    ui::combo("viewport.difference", "", v.difference, names);
    ui::tooltip("How much larger than it is the difference is shown, or in shares of the other picture (H: the next)");
  }
}

// A bar of the colours, and the difference in numbers, which are taken four times a second.
void draw_difference_key(Editor& editor, ImVec2 high) {
  Viewport& v = editor.viewport;
  const DifferenceLook& row = differences[v.difference];
  DifferenceNumbers& n = v.apart;
  if (editor.now - n.at > 0.25 || n.look != v.difference || n.against != v.against) {
    std::vector<float> all = editor.pictures->difference(ui::PictureId::Scene, v.against, row.relative);
    n = {.at = editor.now, .look = v.difference, .against = v.against, .any = !all.empty()};
    if (n.any) {
      std::sort(all.begin(), all.end());
      for (const float x : all) n.mean += x / float(all.size());
      n.p95 = all[size_t(0.95 * double(all.size() - 1))];
      n.most = all.back();
    }
  }
  const std::string text = n.any ? fmt::format("mean {:.4g}, p95 {:.4g}, most {:.4g}", n.mean, n.p95, n.most)
                                 : "the pictures are not of one size";
  const float line = ImGui::GetFontSize(), width = std::max(ImGui::CalcTextSize(text.c_str()).x, line * 10);
  const ImVec2 low(high.x - width - 12, high.y - line * 6.2f);
  ImDrawList* list = ImGui::GetWindowDrawList();
  list->AddRectFilled(ImVec2(low.x - 4, low.y - 2), ImVec2(high.x - 8, low.y + line * 2.9f), IM_COL32(0, 0, 0, 150), 3);
  constexpr int steps = 48;
  for (int i = 0; i < steps; ++i) {
    const float x[4] = {(float(i) + 0.5f) / steps, 0, 0, 0};
    const auto c = shown_color(x, {.show = ui::Show::FalseColor, .low = 0, .high = 1});
    list->AddRectFilled(ImVec2(low.x + width * float(i) / steps, low.y),
                        ImVec2(low.x + width * float(i + 1) / steps, low.y + line * 0.6f),
                        ImGui::ColorConvertFloat4ToU32(ImVec4(c[0], c[1], c[2], 1)));
  }
  const std::string most = fmt::format("{:g}{}", row.white, row.relative ? " of the other" : "");
  list->AddText(ImVec2(low.x, low.y + line * 0.7f), IM_COL32_WHITE, "0");
  list->AddText(ImVec2(low.x + width - ImGui::CalcTextSize(most.c_str()).x, low.y + line * 0.7f), IM_COL32_WHITE,
                most.c_str());
  list->AddText(ImVec2(low.x, low.y + line * 1.75f), IM_COL32_WHITE, text.c_str());
  ui::note_area("viewport.difference.mean", low.x, low.y, width, line, fmt::format("{}", n.mean));
  ui::note_area("viewport.difference.most", low.x, low.y, width, line, fmt::format("{}", n.most));
}

struct Basis {
  glm::vec3 forward, right, up;
};
Basis basis_of(const scene::Camera& camera) {
  Basis b{.forward = glm::normalize(camera.forward), .right = {}, .up = {}};
  b.right = glm::normalize(glm::cross(b.forward, camera.up));
  b.up = glm::cross(b.right, b.forward);
  return b;
}

void turn(CameraControl& c, float yaw, float pitch) {
  const glm::vec3 axis(0, 1, 0);
  glm::vec3 f = glm::normalize(glm::vec3(glm::mat4_cast(glm::angleAxis(yaw, axis)) * glm::vec4(c.camera.forward, 0)));
  const float now = std::asin(std::clamp(f.y, -1.0f, 1.0f)), then = std::clamp(now + pitch, -1.55f, 1.55f);
  const glm::vec2 flat = glm::normalize(glm::vec2(f.x, f.z));
  f = {flat.x * std::cos(then), std::sin(then), flat.y * std::cos(then)};
  c.camera.forward = f;
  c.camera.up = axis;
}

// RMB: look, with WASDQE fly; Alt+LMB: orbit; MMB: pan; wheel: dolly.
void control_camera(Editor& editor, bool active) {
  CameraControl& c = editor.view;
  ImGuiIO& io = ImGui::GetIO();
  const float dt = std::min(io.DeltaTime, 0.1f);
  const Basis b = basis_of(c.camera);
  const auto held = [&](int key) { return editor.input && editor.input->held(key) ? 1.0f : 0.0f; };
  const bool looking = active && ImGui::IsMouseDown(1), panning = active && ImGui::IsMouseDown(2);
  const bool orbiting = active && ImGui::IsMouseDown(0) && io.KeyAlt;
  const float distance = std::max(glm::length(c.target - c.camera.position), 0.05f);
  if (looking && (io.MouseDelta.x != 0 || io.MouseDelta.y != 0)) {
    turn(c, -io.MouseDelta.x * 0.004f, -io.MouseDelta.y * 0.004f);
    c.target = c.camera.position + c.camera.forward * distance;
    c.moved = true;
  }
  if (looking) {
    const glm::vec3 step = b.forward * (held(GLFW_KEY_W) - held(GLFW_KEY_S)) +
                           b.right * (held(GLFW_KEY_D) - held(GLFW_KEY_A)) +
                           glm::vec3(0, 1, 0) * (held(GLFW_KEY_E) - held(GLFW_KEY_Q));
    const float fast = io.KeyShift ? 4.0f : 1.0f;
    if (step != glm::vec3(0)) {
      c.camera.position += step * (c.speed * fast * dt);
      c.target += step * (c.speed * fast * dt);
      c.moved = true;
    }
    if (io.MouseWheel != 0) c.speed = std::clamp(c.speed * std::pow(1.2f, io.MouseWheel), 0.01f, 1000.0f);
  } else if (editor.viewport.hovered && io.MouseWheel != 0) {
    c.camera.position = c.target + (c.camera.position - c.target) * std::pow(0.85f, io.MouseWheel);
    c.moved = true;
  }
  if (orbiting && (io.MouseDelta.x != 0 || io.MouseDelta.y != 0)) {
    turn(c, -io.MouseDelta.x * 0.006f, -io.MouseDelta.y * 0.006f);
    c.camera.position = c.target - glm::normalize(c.camera.forward) * distance;
    c.moved = true;
  }
  if (panning && (io.MouseDelta.x != 0 || io.MouseDelta.y != 0)) {
    const float meters = 2 * distance * std::tan(c.camera.vfov / 2) / std::max(editor.viewport.height, 1.0f);
    const glm::vec3 step = (-b.right * io.MouseDelta.x + b.up * io.MouseDelta.y) * meters;
    c.camera.position += step;
    c.target += step;
    c.moved = true;
  }
}

void draw_picture(Editor& editor, ImVec2 low, ImVec2 size) {
  Viewport& v = editor.viewport;
  ImDrawList* list = ImGui::GetWindowDrawList();
  const ImVec2 high = low + size;
  const bool floats = !editor.picture.floats.empty();
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
  void* other = v.compare == CompareMode::Off || v.compare == CompareMode::Difference
                    ? nullptr
                    : editor.pictures->show(v.against, floats ? look : ui::PictureLook{.nearest = look.nearest});
  const bool blink = v.compare == CompareMode::Blink &&
                     std::fmod(editor.now, 2.0 * double(v.blink_seconds)) >= double(v.blink_seconds);
  if (v.compare == CompareMode::Difference) {
    const DifferenceLook& row = differences[v.difference];
    void* apart =
        editor.pictures->show_difference(ui::PictureId::Scene, v.against, row.white, row.relative, look.nearest);
    list->AddImage(apart ? apart : scene, low, high);
    if (apart) draw_difference_key(editor, high);
  } else if (blink && other) {
    list->AddImage(other, low, high);
  } else {
    list->AddImage(scene, low, high);
  }
  if (v.compare == CompareMode::Wipe && other) {
    const float at = low.x + size.x * v.wipe;
    list->AddImage(other, low, ImVec2(at, high.y), ImVec2(0, 0), ImVec2(v.wipe, 1));
    list->AddLine(ImVec2(at, low.y), ImVec2(at, high.y), IM_COL32(255, 255, 255, 220), 2);
  }
  // Each side says what it is; a difference, of what.
  const std::string mine = picture_label(editor);
  const std::string others = v.against == ui::PictureId::SlotA
                                 ? "A: " + v.label_a
                                 : fmt::format("reference, {} samples a pixel", editor.reference.picture.spp);
  const float y = high.y - ImGui::GetFontSize() * 3.2f;
  const auto label = [&](const char* id, float x, const std::string& text) {
    const ImVec2 extent = ImGui::CalcTextSize(text.c_str());
    list->AddRectFilled(ImVec2(x - 4, y - 2), ImVec2(x + extent.x + 4, y + extent.y + 2), IM_COL32(0, 0, 0, 150), 3);
    list->AddText(ImVec2(x, y), IM_COL32(255, 255, 255, 230), text.c_str());
    ui::note_area(id, x, y, extent.x, extent.y, text);
  };
  const float right = high.x - 8 - ImGui::CalcTextSize(mine.c_str()).x;
  if (v.compare == CompareMode::Wipe && other) {
    label("viewport.label.other", low.x + 8, others);
    label("viewport.label.this", right, mine);
  } else if (v.compare == CompareMode::Blink && other) {
    label(blink ? "viewport.label.other" : "viewport.label.this", blink ? low.x + 8 : right, blink ? others : mine);
  } else if (v.compare == CompareMode::Difference && editor.pictures->size_of(v.against).x > 0) {
    label("viewport.label.other", low.x + 8, mine + "  less  " + others);
  }
  if (v.compare != CompareMode::Off && v.compare != CompareMode::Difference && !other)
    list->AddText(ImVec2(low.x + 8, low.y + 8), IM_COL32(255, 200, 90, 255),
                  v.against == ui::PictureId::SlotA ? "nothing to compare with: press Set A first"
                                                    : "no reference yet: R starts one");
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
  if (preview->probe) fit_range(editor.fetched.pixels, look);
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
  if (!editor.preferences.hide_ui && !editor.picture.floats.empty()) draw_look("viewport", v.look, v.auto_range, true);
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

void fit_range(const live::Pixels& pixels, ui::PictureLook& look) {
  float low = INFINITY, high = -INFINITY;
  const size_t count = pixels.floats.size() / 4;
  const uint32_t channels = std::min(pixels.channels, 3u);
  for (size_t i = 0; i < count; ++i)
    for (uint32_t c = 0; c < channels; ++c) {
      const float x = pixels.floats[i * 4 + c];
      if (!std::isfinite(x)) continue;
      low = std::min(low, x);
      high = std::max(high, x);
    }
  if (low > high) low = 0, high = 1;
  // Colours and shares begin at nothing.
  if (low > 0 && low < 0.5f * high) low = 0;
  if (high <= low) high = low + 1;
  look.low = low;
  look.high = high;
  if (channels == 1 && look.show == ui::Show::Rgb) look.show = ui::Show::Red;
  if (channels > 1 && look.show == ui::Show::Red) look.show = ui::Show::Rgb;
}

// On the same line if the next item, so wide, still fits.
static void beside(float width) {
  const float edge = ImGui::GetWindowPos().x + ImGui::GetWindowContentRegionMax().x;
  if (ImGui::GetItemRectMax().x + ImGui::GetStyle().ItemSpacing.x + width <= edge) ImGui::SameLine();
}

void draw_look(const std::string& id, ui::PictureLook& look, bool& auto_range, bool floats) {
  if (!floats) return;
  int show = int(look.show);
  const float line = ImGui::GetFontSize();
  const auto box = [](const char* label) {
    return ImGui::GetFrameHeight() + ImGui::GetStyle().ItemInnerSpacing.x + ImGui::CalcTextSize(label).x;
  };
  const auto drag = [&](const char* name, float& value) {
    beside(line * 5);
    ImGui::SetNextItemWidth(line * 5);
    if (ImGui::DragFloat(fmt::format("##{}{}", id, name).c_str(), &value, 0.01f, 0, 0, "%.4g")) auto_range = false;
    ui::note(id + name, fmt::format("{:g}", value));
  };
  ImGui::SetNextItemWidth(line * 7);
  if (ui::combo(id + ".show", "", show, {"RGB", "R", "G", "B", "A", "false colour"})) look.show = ui::Show(show);
  beside(box("fit"));
  ui::checkbox(id + ".auto_range", "fit", auto_range, "Range from the smallest to the largest number, each frame");
  drag(".low", look.low);
  drag(".high", look.high);
  beside(box("sRGB"));
  ui::checkbox(id + ".srgb", "sRGB", look.srgb, "Show linear light through the sRGB curve");
  beside(box("outside"));
  ui::checkbox(id + ".mark", "outside", look.mark_outside, "Blue below the range, red above it; NaN is magenta always");
}

}  // namespace nf::editor
