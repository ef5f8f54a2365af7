// The picture against another: wiped, in turns, or the difference of the two; what each side is and how far from the
// reference.
#include <algorithm>
#include <cmath>
#include <imgui.h>

#include "actions.h"
#include "look.h"
#include "panels/panels.h"
#include "settings.h"
#include "ui/widgets.h"

namespace nf::editor {
namespace {

struct Place {
  ImVec2 low, size;
  ImVec2 high() const { return {low.x + size.x, low.y + size.y}; }
};

std::string error_of(const LiveError& error) {
  return fmt::format("RMSE {:.4g} (floor {:.2g})", error.rmse, error.rmse_floor);
}

// Of the picture that is shown, as the reference panel has it; or what is missing for one.
std::string shown_error(const Editor& editor) {
  const ReferenceView& r = editor.reference;
  if (!r.on) return "no error: R starts a reference";
  if (r.layer != editor.viewport.layer)
    return fmt::format("no error: the reference has no layer '{}'", editor.viewport.layer);
  if (editor.wanted.playing) return "no error: the clock runs";
  if (!r.has_error || r.error_revision != editor.shown_revision) return "its error is on its way";
  return error_of(r.error);
}

std::string kept_error(const Editor& editor) {
  const ReferenceView& r = editor.reference;
  if (!r.on) return "no error: R starts a reference";
  if (!r.a_missing.empty()) return "no error: " + r.a_missing;
  return r.has_error_a ? error_of(r.error_a) : "its error is on its way";
}

std::string reference_label(const Editor& editor) {
  const ReferenceView& r = editor.reference;
  std::string text = fmt::format("reference, {} samples a pixel", r.picture.spp);
  if (const LiveReference::Layer* layer = r.picture.layer(r.layer))
    text += fmt::format("\nits own noise {:.4g}", layer->noise);
  return text;
}

// Its lower edge stands at the same height whatever it says.
void draw_label(const Place& at, const char* id, const std::string& text, bool right, float widest) {
  ImDrawList* list = ImGui::GetWindowDrawList();
  const ImVec2 extent = ImGui::CalcTextSize(text.c_str(), nullptr, false, widest);
  const float x = right ? at.high().x - 8 - extent.x : at.low.x + 8;
  const float y = std::max(at.high().y - ImGui::GetFontSize() * 2.2f - extent.y, at.low.y);
  list->AddRectFilled(ImVec2(x - 4, y - 2), ImVec2(x + extent.x + 4, y + extent.y + 2), IM_COL32(0, 0, 0, 150), 3);
  list->AddText(ImGui::GetFont(), ImGui::GetFontSize(), ImVec2(x, y), IM_COL32(255, 255, 255, 230), text.c_str(),
                nullptr, widest);
  std::string line = text;
  std::replace(line.begin(), line.end(), '\n', ' ');
  ui::note_area(id, x, y, extent.x, extent.y, line);
}

// The difference in numbers, which are taken four times a second; FLIP's come when they are made.
std::string difference_text(Editor& editor, double& mean, double& most) {
  Viewport& v = editor.viewport;
  const DifferenceLook& row = differences[v.difference];
  if (row.flip) {
    const image::Pooled& p = editor.flip.result.pooled;
    mean = p.mean;
    most = p.max;
    return fmt::format("mean {:.4g}, p95 {:.4g}, max {:.4g}{}", p.mean, p.p95, p.max,
                       editor.flip.current ? "" : ", the new one is on its way");
  }
  DifferenceNumbers& n = v.apart;
  if (editor.now - n.at > 0.25 || n.look != v.difference || n.against != v.against) {
    const std::vector<float> all = editor.pictures->difference(ui::PictureId::Scene, v.against, row.relative);
    n = {editor.now, v.difference, v.against, capture::statistics({all.begin(), all.end()})};
  }
  mean = n.of.mean;
  most = n.of.max;
  return n.of.count ? fmt::format("mean {:.4g}, p95 {:.4g}, max {:.4g}", n.of.mean, n.of.p95, n.of.max)
                    : "the pictures are not of one size";
}

// A bar of the colours, what their ends are, and the numbers.
void draw_key(Editor& editor, ImVec2 high) {
  const DifferenceLook& row = differences[editor.viewport.difference];
  double mean = 0, most = 0;
  const std::string text = difference_text(editor, mean, most);
  const float line = ImGui::GetFontSize(), width = std::max(ImGui::CalcTextSize(text.c_str()).x, line * 10);
  const ImVec2 low(high.x - width - 12, high.y - line * 6.2f);
  ImDrawList* list = ImGui::GetWindowDrawList();
  list->AddRectFilled(ImVec2(low.x - 4, low.y - 2), ImVec2(high.x - 8, low.y + line * 2.9f), IM_COL32(0, 0, 0, 150), 3);
  constexpr int steps = 48;
  for (int i = 0; i < steps; ++i) {
    const float x[4] = {(float(i) + 0.5f) / steps, 0, 0, 0};
    const auto c = shown_color(x, {.map = ui::Map::FalseColor, .low = 0, .high = 1});
    const image::Rgb8 m = image::magma_color(x[0]);
    list->AddRectFilled(
        ImVec2(low.x + width * float(i) / steps, low.y),
        ImVec2(low.x + width * float(i + 1) / steps, low.y + line * 0.6f),
        row.flip ? IM_COL32(m.r, m.g, m.b, 255) : ImGui::ColorConvertFloat4ToU32(ImVec4(c[0], c[1], c[2], 1)));
  }
  const std::string end = row.flip ? fmt::format("1  {}-FLIP", editor.flip.result.hdr ? "HDR" : "LDR")
                                   : fmt::format("{:g}{}", row.white, row.relative ? " of the other" : "");
  list->AddText(ImVec2(low.x, low.y + line * 0.7f), IM_COL32_WHITE, "0");
  list->AddText(ImVec2(low.x + width - ImGui::CalcTextSize(end.c_str()).x, low.y + line * 0.7f), IM_COL32_WHITE,
                end.c_str());
  list->AddText(ImVec2(low.x, low.y + line * 1.75f), IM_COL32_WHITE, text.c_str());
  ui::note_area("viewport.difference.key", low.x, low.y, width, line, text);
  ui::note_area("viewport.difference.mean", low.x, low.y, width, line, fmt::format("{}", mean));
  ui::note_area("viewport.difference.most", low.x, low.y, width, line, fmt::format("{}", most));
  if (!row.flip) return;
  ui::note_area("viewport.difference.p95", low.x, low.y, width, line, fmt::format("{}", editor.flip.result.pooled.p95));
  ui::note_area("viewport.difference.current", low.x, low.y, width, line, editor.flip.current ? "true" : "false");
}

void say(const Place& at, const std::string& text) {
  ImDrawList* list = ImGui::GetWindowDrawList();
  const ImVec2 extent = ImGui::CalcTextSize(text.c_str());
  const ImVec2 low(at.low.x + 8, at.low.y + 8);
  list->AddRectFilled(ImVec2(low.x - 4, low.y - 2), ImVec2(low.x + extent.x + 4, low.y + extent.y + 2),
                      IM_COL32(0, 0, 0, 170), 3);
  list->AddText(low, IM_COL32(255, 200, 90, 255), text.c_str());
  ui::note_area("viewport.compare.note", low.x, low.y, extent.x, extent.y, text);
}

// The difference in the picture's place; false: there is none to show, and why was said.
void draw_difference(Editor& editor, const Place& at, void* scene, bool nearest) {
  Viewport& v = editor.viewport;
  const DifferenceLook& row = differences[v.difference];
  ui::Renderer& p = *editor.pictures;
  void* apart = nullptr;
  if (!row.flip)
    apart = p.show_difference(ui::PictureId::Scene, v.against, row.white, row.relative, nearest);
  else if (editor.flip.has)
    apart = p.show(ui::PictureId::Flip, {.nearest = nearest});
  ImGui::GetWindowDrawList()->AddImage(apart ? apart : scene, at.low, at.high());
  if (apart) draw_key(editor, at.high());
  if (row.flip && !editor.flip.note.empty())
    say(at, editor.flip.note);
  else if (row.flip && !apart)
    say(at, "FLIP is on its way ...");
}

}  // namespace

void draw_compare_tools(Editor& editor) {
  Viewport& v = editor.viewport;
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
    ui::tooltip(
        "How much larger than it is the difference is shown, in shares of the other picture, or as the eye sees it "
        "when the two stand in turns (FLIP) (H: the next)");
  }
}

void draw_compared(Editor& editor, float x, float y, float width, float height, void* scene,
                   const ui::PictureLook& look) {
  Viewport& v = editor.viewport;
  const Place at{{x, y}, {width, height}};
  ImDrawList* list = ImGui::GetWindowDrawList();
  const bool there = editor.pictures->size_of(v.against).x > 0;
  const bool difference = v.compare == CompareMode::Difference;
  void* other = v.compare == CompareMode::Off || difference ? nullptr : editor.pictures->show(v.against, look);
  const bool blink = v.compare == CompareMode::Blink &&
                     std::fmod(editor.now, 2.0 * double(v.blink_seconds)) >= double(v.blink_seconds);
  if (difference && there)
    draw_difference(editor, at, scene, look.nearest);
  else
    list->AddImage(blink && other ? other : scene, at.low, at.high());
  if (v.compare == CompareMode::Wipe && other) {
    const float middle = x + width * v.wipe;
    list->AddImage(other, at.low, ImVec2(middle, y + height), ImVec2(0, 0), ImVec2(v.wipe, 1));
    list->AddLine(ImVec2(middle, y), ImVec2(middle, y + height), IM_COL32(255, 255, 255, 220), 2);
  }
  if (v.compare == CompareMode::Off) return;
  const bool slot = v.against == ui::PictureId::SlotA;
  if (!there) return say(at, slot ? "nothing to compare with: press Set A first" : "no reference yet: R starts one");
  // Each side says what it is and how wrong; a difference, of what.
  const std::string mine = picture_label(editor);
  const std::string others = slot ? "A: " + v.label_a : reference_label(editor);
  if (difference) {
    draw_label(at, "viewport.label.other", mine + "  less  " + others.substr(0, others.find('\n')), false, width - 16);
    return;
  }
  const float widest = std::max(width / 2 - 24, 40.0f);
  if (v.compare == CompareMode::Wipe || blink)
    draw_label(at, "viewport.label.other", slot ? others + "\n" + kept_error(editor) : others, false, widest);
  if (v.compare == CompareMode::Wipe || !blink)
    draw_label(at, "viewport.label.this", mine + "\n" + shown_error(editor), true, widest);
  const ReferenceView& r = editor.reference;
  if (r.has_error) ui::note_area("viewport.rmse.this", x, y, 1, 1, fmt::format("{}", r.error.rmse));
  if (r.has_error_a && slot) ui::note_area("viewport.rmse.other", x, y, 1, 1, fmt::format("{}", r.error_a.rmse));
}

}  // namespace nf::editor
