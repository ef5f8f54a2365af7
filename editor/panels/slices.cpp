// The slice inspector: the picked pixel's samples over the picture, the fan of its slices, and one slice as a half disc
// whose sectors are covered sample by sample.
#include <algorithm>
#include <cmath>
#include <imgui.h>

#include "panels/panels.h"
#include "ui/widgets.h"

namespace nf::editor {
namespace {

using passes::InspectedSample;
using passes::InspectedSlice;
using passes::Inspection;
using passes::InspectReason;

constexpr float pi = 3.14159265f;
constexpr ImU32 faint = IM_COL32(150, 150, 160, 255), occluded = IM_COL32(105, 108, 118, 255),
                fresh_edge = IM_COL32(255, 214, 80, 255);

// Light as a colour: its hue always, its strength within what a screen shows.
ImU32 light_color(glm::vec3 light, int alpha = 255) {
  const float most = std::max({light.x, light.y, light.z, 1e-9f});
  const float strength = 0.35f + 0.65f * std::min(std::sqrt(most), 1.0f);
  const glm::vec3 c = glm::pow(glm::max(light / most, 0.0f), glm::vec3(1 / 2.2f)) * strength * 255.0f;
  return IM_COL32(int(c.x), int(c.y), int(c.z), alpha);
}

ImU32 slice_color(int slice, int alpha = 255) {
  float r, g, b;
  ImGui::ColorConvertHSVtoRGB(std::fmod(0.55f + 0.618034f * float(slice), 1.0f), 0.6f, 1, r, g, b);
  return IM_COL32(int(r * 255), int(g * 255), int(b * 255), alpha);
}

// Not by colour alone: what counts is a disc, what adds nothing a ring, what is rejected a cross.
void draw_dot(ImDrawList* list, ImVec2 at, float size, const InspectedSample& sample, const SliceView& s,
              int alpha = 255) {
  const bool rejected = sample.reason != InspectReason::Counted && sample.reason != InspectReason::NothingNew;
  ImU32 color = sample.reason == InspectReason::Counted ? IM_COL32(255, 255, 255, 255)
                : rejected                              ? IM_COL32(235, 90, 80, 255)
                                                        : IM_COL32(170, 170, 175, 255);
  if (s.color == DotColor::Slice) color = slice_color(sample.slice);
  color = (color & 0x00ffffffu) | ImU32(alpha) << 24;
  const ImU32 dark = IM_COL32(0, 0, 0, alpha);
  if (rejected) {
    for (const float sign : {-1.0f, 1.0f}) {
      const ImVec2 a(at.x - size, at.y - sign * size), b(at.x + size, at.y + sign * size);
      list->AddLine(a, b, dark, 3);
      list->AddLine(a, b, color, 1.5f);
    }
  } else if (sample.reason == InspectReason::Counted) {
    list->AddCircleFilled(at, size + 1.5f, dark);
    list->AddCircleFilled(at, size, color);
  } else {
    list->AddCircle(at, size, dark, 0, 3);
    list->AddCircle(at, size, color, 0, 1.5f);
  }
}

int bits_of(const std::array<uint32_t, 4>& words) {
  int count = 0;
  for (const uint32_t word : words) count += __builtin_popcount(word);
  return count;
}

// Where there are several lists of points they are rays.
bool has_rays(const Inspection& in) {
  return in.sectors < 0 && in.slices.size() > 1;
}
const char* slice_word(const Inspection& in) {
  return has_rays(in) ? "ray" : "slice";
}

std::string describe(const Inspection& in, const InspectedSample& s) {
  std::string text = fmt::format("{} {}, side {}, step {}: {}\ntexel {}, {}, depth {:.4g} m, {:.3g} m away",
                                 slice_word(in), s.slice, s.side, s.step, passes::inspect_reason_name(s.reason),
                                 s.texel.x, s.texel.y, s.depth, glm::length(s.towards));
  if (in.sectors > 0)
    text += fmt::format("\nsectors {:.2f} to {:.2f}, {} of them new", s.front, s.back, bits_of(s.fresh));
  text += fmt::format("\ncounts by {:.3g}, takes {:.4g}", s.weight, s.taken);
  if (s.light != glm::vec3(0)) text += fmt::format("\nlight {:.4g} {:.4g} {:.4g}", s.light.x, s.light.y, s.light.z);
  return text;
}

bool is_shown(const SliceView& s, const std::vector<size_t>& rows, size_t row) {
  if (s.shown < 0) return true;
  const auto at = std::find(rows.begin(), rows.end(), row);
  return at == rows.end() || at - rows.begin() < s.shown;
}

// What a sector of the selected slice shows: free, occluded, or the light that came through it.
ImU32 sector_color(const InspectedSample& sample, int alpha) {
  if (sample.light == glm::vec3(0)) return (occluded & 0x00ffffffu) | ImU32(alpha) << 24;
  const float sectors = std::max(sample.taken, 1e-6f);
  return light_color(sample.light / sectors, alpha);
}

void draw_half_disc(Editor& editor, const Inspection& in, const std::vector<size_t>& rows) {
  const SliceView& s = editor.slices;
  const InspectedSlice& slice = in.slices[size_t(s.slice)];
  const float line = ImGui::GetFontSize(), width = ImGui::GetContentRegionAvail().x;
  const float radius = std::max(std::min(width * 0.5f - line * 1.6f, line * 14), line * 3);
  const ImVec2 low = ImGui::GetCursorScreenPos();
  const ImVec2 middle(low.x + width * 0.5f, low.y + radius + line * 1.4f);
  ImGui::InvisibleButton("half disc", ImVec2(std::max(width, 1.0f), radius + line * 2.2f));
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  const bool hovered = ImGui::IsItemHovered();
  ImDrawList* list = ImGui::GetWindowDrawList();
  const auto at = [&](float theta, float r) {
    return ImVec2(middle.x + r * std::sin(theta), middle.y - r * std::cos(theta));
  };
  const int last = s.shown < 0 ? -1 : s.shown - 1;
  const float inner = radius * 0.62f;
  int hovered_sample = -1;
  const auto arc = [&](float a, float b) {
    list->PathClear();
    list->PathArcTo(middle, radius, a - pi / 2, b - pi / 2, 12);
    list->PathArcTo(middle, inner, b - pi / 2, a - pi / 2, 12);
  };
  for (int sector = 0; sector < in.sectors; ++sector) {
    const float a = angle_at(slice, float(sector)), b = angle_at(slice, float(sector + 1));
    if (b <= a) continue;
    arc(a, b);
    list->PathStroke(faint, ImDrawFlags_Closed, 1);
  }
  const float r = std::hypot(mouse.x - middle.x, mouse.y - middle.y);
  const float theta_here = std::atan2(mouse.x - middle.x, middle.y - mouse.y);
  const std::vector<Wedge> wedges = wedges_of(in, s.slice, s.shown);
  for (const Wedge& wedge : wedges) {
    const bool newest = wedge.number == last;
    // A ring's part is convex only where it is short.
    const int parts = std::max(int((wedge.to - wedge.from) / 0.1f), 1);
    for (int i = 0; i < parts; ++i) {
      const float step = (wedge.to - wedge.from) / float(parts);
      arc(wedge.from + step * float(i), wedge.from + step * float(i + 1));
      list->PathFillConvex(sector_color(in.samples[rows[size_t(wedge.number)]], 255));
    }
    arc(wedge.from, wedge.to);
    list->PathStroke(newest ? fresh_edge : faint, ImDrawFlags_Closed, newest ? 2.5f : 1);
    const std::string text = fmt::format("{}", wedge.number + 1);
    const ImVec2 extent = ImGui::CalcTextSize(text.c_str());
    // Where the sector is too thin for its number, none.
    if ((wedge.to - wedge.from) * radius > extent.x * 0.8f) {
      const ImVec2 p = at((wedge.from + wedge.to) / 2, radius + line * 0.55f);
      list->AddText(ImVec2(p.x - extent.x / 2, p.y - extent.y / 2), faint, text.c_str());
    }
    if (hovered && r > inner && r < radius && theta_here >= wedge.from && theta_here < wedge.to)
      hovered_sample = wedge.number;
  }
  // Samples by angle, farther ones further out; the line of sight and the surface.
  list->AddLine(at(-pi / 2, radius * 1.04f), at(pi / 2, radius * 1.04f), faint, 1.5f);
  const float gamma = std::atan2(slice.sin_gamma, slice.cos_gamma);
  list->AddLine(middle, at(gamma, radius), IM_COL32(120, 190, 255, 255), 1.5f);
  list->AddText(at(gamma, inner * 0.5f), IM_COL32(120, 190, 255, 255), "eye");
  list->AddLine(middle, at(0, inner), IM_COL32(140, 230, 140, 255), 1.5f);
  const auto place = [&](float x, float y) {
    const float out = inner * 0.95f * std::sqrt(std::min(std::hypot(x, y) / std::max(in.radius, 1e-6f), 1.0f));
    return at(std::clamp(std::atan2(x, y), -pi / 2, pi / 2), out);
  };
  for (size_t i = 0; i < rows.size(); ++i) {
    const InspectedSample& sample = in.samples[rows[i]];
    if (sample.depth <= 0 || (s.shown >= 0 && int(i) >= s.shown)) continue;
    const ImVec2 p = place(glm::dot(sample.towards, slice.tangent), glm::dot(sample.towards, slice.normal));
    draw_dot(list, p, line * 0.17f, sample, s);
    if (int(i) == last) list->AddCircle(p, line * 0.4f, fresh_edge, 0, 2);
    if (hovered && std::hypot(mouse.x - p.x, mouse.y - p.y) < line * 0.35f) hovered_sample = int(i);
  }
  if (last >= 0 && size_t(last) < rows.size() && in.sectors > 0) {
    const InspectedSample& sample = in.samples[rows[size_t(last)]];
    const float a = angle_at(slice, std::min(sample.front, sample.back)),
                b = angle_at(slice, std::max(sample.front, sample.back));
    list->PathClear();
    list->PathArcTo(middle, inner * 0.97f, a - pi / 2, b - pi / 2, 24);
    list->PathStroke(fresh_edge, 0, 3);
    // Lines to its front and its back, and between them what it is taken to be thick, along its own line of sight.
    const glm::vec3 ray = glm::normalize(in.ray * in.depth + sample.towards);
    const float theta = angle_at(slice, sample.back), x = glm::dot(sample.towards, slice.tangent),
                y = glm::dot(sample.towards, slice.normal), dx = glm::dot(ray, slice.tangent),
                dy = glm::dot(ray, slice.normal);
    const float behind = (x * std::cos(theta) - y * std::sin(theta)) / (dy * std::sin(theta) - dx * std::cos(theta));
    if (sample.depth > 0) list->AddLine(middle, place(x, y), fresh_edge, 1);
    if (sample.depth > 0 && sample.front != sample.back && behind > 0 && behind < in.radius) {
      const ImVec2 back = place(x + behind * dx, y + behind * dy);
      list->AddLine(middle, back, faint, 1);
      list->AddLine(place(x, y), back, fresh_edge, 2);
      ui::note("slices.thickness", fmt::format("{:.4f}", behind));
    }
  }
  ui::note("slices.disc", fmt::format("{}", wedges.size()));
  if (hovered_sample >= 0) ImGui::SetTooltip("%s", describe(in, in.samples[rows[size_t(hovered_sample)]]).c_str());
}

void draw_numbers(const live::Inspected& seen) {
  const Inspection& in = seen.data;
  ImGui::Text("%s at %d, %d: %zu %ss, %zu samples", seen.technique.c_str(), in.pixel.x, in.pixel.y, in.slices.size(),
              slice_word(in), in.samples.size());
  ui::note("slices.technique", seen.technique);
  const float sum = in.summed_visibility();
  const glm::vec3 light = in.summed_gi();
  ImGui::Text("visibility %.4f, sum of the records %.4f", double(in.visibility), double(sum));
  ui::note("slices.visibility", fmt::format("{}", in.visibility));
  if (in.gi != glm::vec3(0) || light != glm::vec3(0))
    ImGui::Text("light %.4f %.4f %.4f, sum %.4f %.4f %.4f", double(in.gi.x), double(in.gi.y), double(in.gi.z),
                double(light.x), double(light.y), double(light.z));
  ui::note("slices.error", fmt::format("{}", std::abs(sum - in.visibility) + glm::length(light - in.gi)));
  const size_t counted = in.count(InspectReason::Counted), all = std::max<size_t>(in.samples.size(), 1);
  const double idle = 100.0 * double(in.samples.size() - counted) / double(all);
  ImGui::Text("%.0f %% of the samples added nothing", idle);
  ui::note("slices.idle", fmt::format("{:.3f}", idle));
  std::string parts;
  for (int i = 1; i <= int(InspectReason::NothingNew); ++i)
    if (const size_t count = in.count(InspectReason(i)))
      parts += fmt::format("{}{} {}", parts.empty() ? "" : ", ", count, passes::inspect_reason_name(InspectReason(i)));
  if (!parts.empty()) ImGui::TextDisabled("%s", parts.c_str());
}

struct Projector {
  float x, y, width, height, tangent_x, tangent_y;
  bool project(glm::vec3 p, ImVec2& out) const {
    if (p.z > -1e-3f) return false;
    out = {x + width * (0.5f + 0.5f * p.x / (-p.z * tangent_x)), y + height * (0.5f - 0.5f * p.y / (-p.z * tangent_y))};
    return true;
  }
};

// The hemisphere's slices as half discs that stand on the surface.
void draw_fan(const SliceView& s, const Inspection& in, const Projector& eye) {
  ImDrawList* list = ImGui::GetWindowDrawList();
  const glm::vec3 position = in.ray * in.depth;
  // As large as a sixth of the picture's height, whatever the distance.
  const float reach = in.depth * eye.tangent_y / 3;
  const auto point = [&](const InspectedSlice& slice, float theta, ImVec2& out) {
    return eye.project(position + reach * (slice.tangent * std::sin(theta) + slice.normal * std::cos(theta)), out);
  };
  ImVec2 base, tip;
  if (!eye.project(position, base)) return;
  for (int i = 0; i < int(in.slices.size()); ++i) {
    const InspectedSlice& slice = in.slices[size_t(i)];
    const bool selected = i == s.slice;
    const std::vector<size_t> rows = samples_of(in, i);
    for (const Wedge& wedge : wedges_of(in, i, selected ? s.shown : -1)) {
      const int parts = std::max(int((wedge.to - wedge.from) / 0.1f), 1);
      for (int k = 0; k < parts; ++k) {
        const float step = (wedge.to - wedge.from) / float(parts);
        ImVec2 a, b;
        if (point(slice, wedge.from + step * float(k), a) && point(slice, wedge.from + step * float(k + 1), b))
          list->AddTriangleFilled(base, a, b,
                                  sector_color(in.samples[rows[size_t(wedge.number)]], selected ? 170 : 70));
      }
    }
    for (int k = 0; k < 32; ++k) {
      ImVec2 a, b;
      if (point(slice, (float(k) / 32 - 0.5f) * pi, a) && point(slice, (float(k + 1) / 32 - 0.5f) * pi, b))
        list->AddLine(a, b, slice_color(i, selected ? 255 : 120), selected ? 2.0f : 1.0f);
    }
  }
  if (eye.project(position + reach * 1.15f * in.normal, tip)) list->AddLine(base, tip, IM_COL32(140, 230, 140, 255), 2);
}

}  // namespace

void draw_samples(Editor& editor, float x, float y, float width, float height) {
  SliceView& s = editor.slices;
  if (!s.on || !s.seen || s.seen->size.x == 0 || s.seen->data.depth <= 0) return;
  const Inspection& in = s.seen->data;
  const glm::vec2 size(s.seen->size);
  const float tangent = std::tan(s.seen->vfov * 0.5f), line = ImGui::GetFontSize();
  ImDrawList* list = ImGui::GetWindowDrawList();
  list->PushClipRect(ImVec2(x, y), ImVec2(x + width, y + height), true);
  if (s.fan && in.sectors >= 0) draw_fan(s, in, {x, y, width, height, tangent * size.x / size.y, tangent});
  const auto place = [&](glm::ivec2 texel) {
    const glm::vec2 at = (glm::vec2(texel) + 0.5f) / size;
    return ImVec2(x + at.x * width, y + at.y * height);
  };
  const std::vector<size_t> rows = samples_of(in, s.slice);
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  // While one slice is gone through the others step back.
  const auto alpha = [&](int slice) { return s.shown >= 0 && slice != s.slice ? 80 : 255; };
  if (has_rays(in)) {
    std::vector<ImVec2> ends(in.slices.size(), place(in.pixel));
    for (size_t i = 0; i < in.samples.size(); ++i) {
      const InspectedSample& sample = in.samples[i];
      if (sample.reason == InspectReason::OffScreen || !is_shown(s, rows, i)) continue;
      const ImVec2 next = place(sample.texel);
      const bool selected = sample.slice == s.slice;
      list->AddLine(ends[size_t(sample.slice)], next,
                    slice_color(sample.slice, selected ? 255 : alpha(sample.slice) / 2), selected ? 2.0f : 1.0f);
      ends[size_t(sample.slice)] = next;
    }
  }
  size_t drawn = 0, dimmed = 0;
  const InspectedSample* under = nullptr;
  for (size_t i = 0; i < in.samples.size(); ++i) {
    const InspectedSample& sample = in.samples[i];
    if (sample.reason == InspectReason::OffScreen || !is_shown(s, rows, i)) continue;
    const ImVec2 p = place(sample.texel);
    draw_dot(list, p, line * (sample.slice == s.slice ? 0.2f : 0.12f), sample, s, alpha(sample.slice));
    ++drawn;
    dimmed += alpha(sample.slice) < 255;
    if (editor.viewport.hovered && std::hypot(mouse.x - p.x, mouse.y - p.y) < line * 0.35f) under = &sample;
  }
  if (s.shown > 0 && size_t(s.shown) <= rows.size())
    list->AddCircle(place(in.samples[rows[size_t(s.shown - 1)]].texel), line * 0.5f, fresh_edge, 0, 2.5f);
  list->PopClipRect();
  ui::note_area("viewport.samples", x, y, width, height, fmt::format("{}", drawn));
  ui::note_area("viewport.samples.dimmed", x, y, width, height, fmt::format("{}", dimmed));
  if (under) ImGui::SetTooltip("%s", describe(in, *under).c_str());
}

void draw_slices_panel(Editor& editor) {
  SliceView& s = editor.slices;
  ui::checkbox("slices.on", "take the pixel apart", s.on,
               "The technique tells each of its samples at the picked pixel (I); click into the picture to pick one");
  if (!s.on) {
    ImGui::TextWrapped(
        "Shows which samples a technique takes for one pixel, what each of them added, and how a slice's sectors "
        "fill.");
    return;
  }
  ImGui::SameLine();
  ui::checkbox("slices.freeze", "freeze", s.frozen, "Keep these samples while the picture goes on");
  if (!s.seen) {
    ImGui::TextDisabled("reading ...");
    return;
  }
  const live::Inspected& seen = *s.seen;
  const Inspection& in = seen.data;
  if (!seen.possible) {
    ImGui::TextWrapped("%s does not tell its samples.", seen.technique.c_str());
    ui::note("slices.none", seen.technique);
    return;
  }
  if (in.depth <= 0 || in.slices.empty()) {
    ImGui::TextWrapped("Nothing is seen at %d, %d: the technique takes no samples there.", in.pixel.x, in.pixel.y);
    ui::note("slices.none", "background");
    return;
  }
  draw_numbers(seen);
  s.slice = std::clamp(s.slice, 0, int(in.slices.size()) - 1);
  const float line = ImGui::GetFontSize();
  int color = int(s.color);
  ImGui::SetNextItemWidth(line * 8);
  if (ui::combo("slices.color", "", color, {"contribution", "slice"})) s.color = DotColor(color);
  ui::tooltip("Colours of the dots. Disc: new sectors; ring: nothing new; cross: rejected");
  ImGui::SameLine();
  ui::checkbox("slices.fan", "fan", s.fan, "Draw the slices into the picture");
  ImGui::SameLine();
  if (ui::button("slices.save", "Export JSON", "All records, into captures/")) s.save_asked = true;
  ImGui::SetNextItemWidth(line * 8);
  if (in.slices.size() > 1) ui::slider_int("slices.slice", slice_word(in), s.slice, 0, int(in.slices.size()) - 1);
  play_samples(editor, ImGui::GetTime());
  const std::vector<size_t> rows = samples_of(in, s.slice);
  s.shown = std::min(s.shown, int(rows.size()));
  if (ui::button("slices.first", "none", "No sample yet")) s.shown = 0;
  ImGui::SameLine();
  if (ui::button("slices.fewer", "<", "One sample less (down)")) step_sample(editor, -1);
  ImGui::SameLine();
  if (ui::button("slices.more", ">", "One sample more (up)")) step_sample(editor, 1);
  ImGui::SameLine();
  if (ui::button("slices.all", "all", "Every sample of the slice")) s.shown = -1, s.playing = false;
  ImGui::SameLine();
  ui::checkbox("slices.play", "play", s.playing,
               "A sample after the other, then the next slice round the line of sight");
  ImGui::SameLine();
  const int shown = s.shown < 0 ? int(rows.size()) : s.shown;
  ImGui::Text("sample %d of %zu", shown, rows.size());
  ui::note("slices.shown", fmt::format("{}", shown));
  if (in.sectors >= 0) draw_half_disc(editor, in, rows);
  if (shown > 0 && size_t(shown) <= rows.size())
    ImGui::TextWrapped("%s", describe(in, in.samples[rows[size_t(shown - 1)]]).c_str());
}

}  // namespace nf::editor
