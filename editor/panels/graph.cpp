// The frame graph: passes against resources, and where transient memory lies over the frame.
#include <algorithm>
#include <imgui.h>

#include "panels/panels.h"
#include "ui/widgets.h"

namespace nf::editor {
namespace {

constexpr ImU32 read_color = IM_COL32(86, 180, 233, 255), write_color = IM_COL32(230, 159, 0, 255);
constexpr double mib = 1048576.0;

const live::GraphInfo::Use* find_use(const live::GraphInfo& graph, size_t pass, size_t resource, bool& read,
                                     bool& write) {
  const live::GraphInfo::Use* found = nullptr;
  for (const live::GraphInfo::Use& use : graph.uses)
    if (use.pass == pass && use.resource == resource) {
      read |= use.read;
      write |= use.write;
      if (!found || (use.write && !found->write)) found = &use;
    }
  return found;
}

live::ProbeWanted probe_of(const live::GraphInfo& graph, const live::GraphInfo::Use& use) {
  return {.pass = graph.passes[use.pass].label,
          .resource = graph.resources[use.resource].name,
          .mip = use.mip,
          .layer = use.layer};
}

void show_texture(Editor& editor, const live::ProbeWanted& wanted) {
  editor.texture.wanted = wanted;
  editor.texture.frozen = false;
  editor.preferences.right_tab = "Texture";
}

}  // namespace

std::optional<Preview> preview_after(const Editor& editor, const std::string& pass, const std::string& resource) {
  const live::GraphInfo& g = editor.graph;
  const auto row = std::find_if(g.passes.begin(), g.passes.end(), [&](const auto& p) { return p.label == pass; });
  if (row == g.passes.end() || row->culled) return std::nullopt;
  for (const live::GraphInfo::Use& use : g.uses) {
    const live::GraphInfo::Resource& r = g.resources[use.resource];
    if (use.pass != uint32_t(row - g.passes.begin()) || r.buffer || r.imported || !r.live) continue;
    if (resource.empty() ? !use.write : r.name != resource) continue;
    return Preview{.title = fmt::format("{} after {}", r.name, pass), .probe = probe_of(g, use)};
  }
  return std::nullopt;
}

void point_at(Editor& editor, std::optional<Preview> preview, bool hovered, bool clicked) {
  if (!preview) return;
  const bool locked = editor.locked_preview && editor.locked_preview->title == preview->title;
  if (clicked && locked)
    editor.locked_preview.reset();
  else if (clicked)
    editor.locked_preview = preview;
  if (hovered) editor.pointed = std::move(preview);
}

namespace {

// Text that rises to the right from `at`. Dear ImGui clips letters where it lays them out, so they are laid out where
// nothing is clipped and then turned.
void draw_slanted(ImDrawList* list, ImVec2 at, ImU32 color, const std::string& text) {
  constexpr float turn_cos = 0.5f, turn_sin = -0.8660254f;  // 60 degrees
  const ImVec2 from = list->GetClipRectMin();
  const int first = list->VtxBuffer.Size;
  list->AddText(from, color, text.c_str());
  for (int v = first; v < list->VtxBuffer.Size; ++v) {
    ImVec2& p = list->VtxBuffer[v].pos;
    const float x = p.x - from.x, y = p.y - from.y;
    p = ImVec2(at.x + x * turn_cos - y * turn_sin, at.y + x * turn_sin + y * turn_cos);
  }
}

void draw_grid(Editor& editor) {
  const live::GraphInfo& g = editor.graph;
  const float line = ImGui::GetFontSize(), cell = line * 1.15f, names = line * 13;
  ImGui::BeginChild("grid", ImVec2(0, 0), false, ImGuiWindowFlags_HorizontalScrollbar);
  // The passes' names stay at the top, and leave rows enough: where room is short their ends are cut off.
  const float head = std::clamp(ImGui::GetContentRegionAvail().y * 0.45f, line * 2.5f, line * 10);
  const ImVec2 origin = ImGui::GetCursorScreenPos();
  ImDrawList* list = ImGui::GetWindowDrawList();
  const ImU32 text = ImGui::GetColorU32(ImGuiCol_Text), grey = ImGui::GetColorU32(ImGuiCol_TextDisabled);
  std::vector<size_t> rows;
  for (size_t r = 0; r < g.resources.size(); ++r)
    if (!g.resources[r].imported) rows.push_back(r);
  ImGui::Dummy(ImVec2(names + cell * float(g.passes.size()) + line * 6, head + cell * float(rows.size()) + line));
  const float top = origin.y + ImGui::GetScrollY(), foot = top + head;
  list->ChannelsSplit(2);  // rows scroll by beneath the names
  list->ChannelsSetCurrent(1);
  list->AddRectFilled(ImVec2(list->GetClipRectMin().x, top), ImVec2(list->GetClipRectMax().x, foot),
                      ImGui::GetColorU32(ImGuiCol_WindowBg));
  for (size_t p = 0; p < g.passes.size(); ++p) {
    const float x = origin.x + names + cell * float(p);
    list->ChannelsSetCurrent(0);
    list->AddLine(ImVec2(x + cell / 2, foot), ImVec2(x + cell / 2, origin.y + head + cell * float(rows.size())),
                  IM_COL32(255, 255, 255, p % 5 == 0 ? 40 : 18));
    list->ChannelsSetCurrent(1);
    draw_slanted(list, ImVec2(x + cell * 0.2f, foot - line * 1.2f), g.passes[p].culled ? grey : text,
                 g.passes[p].label);
    if (g.passes[p].barrier_count)
      list->AddText(ImVec2(x + 2, foot - line * 1.05f), IM_COL32(204, 121, 167, 255),
                    fmt::format("{}", g.passes[p].barrier_count).c_str());
    ImGui::SetCursorScreenPos(ImVec2(x, top));
    ImGui::PushID(int(p));
    const bool clicked = ImGui::InvisibleButton("pass", ImVec2(cell, head));
    ui::note("graph.pass." + g.passes[p].label, g.passes[p].culled ? "culled" : g.passes[p].kind);
    const std::optional<Preview> preview = preview_after(editor, g.passes[p].label);
    if (preview && editor.locked_preview && editor.locked_preview->title == preview->title)
      list->AddRect(ImVec2(x, foot - line * 1.2f), ImVec2(x + cell, foot + cell * float(rows.size())),
                    ImGui::GetColorU32(ImGuiCol_CheckMark));
    point_at(editor, preview, ImGui::IsItemHovered(), clicked);
    if (ImGui::IsItemHovered()) {
      const auto time = std::find_if(editor.timings.rows.begin(), editor.timings.rows.end(),
                                     [&](const TimingHistory::Row& r) { return r.name == g.passes[p].name; });
      ImGui::BeginTooltip();
      ImGui::Text("%s  (%s%s)", g.passes[p].label.c_str(), g.passes[p].kind.c_str(),
                  g.passes[p].culled ? ", culled: nobody needs what it writes" : "");
      ImGui::TextUnformatted(g.passes[p].description.c_str());
      if (time != editor.timings.rows.end() && !time->ms.empty()) ImGui::Text("%.3f ms", double(time->ms.back()));
      ImGui::Text("%u barriers before it", g.passes[p].barrier_count);
      ImGui::TextDisabled("%s", g.passes[p].barriers.c_str());
      if (preview) ImGui::TextUnformatted("in the viewport: what it writes first; click: keep it there, Esc: let go");
      ImGui::EndTooltip();
    }
    ImGui::PopID();
  }
  list->ChannelsSetCurrent(0);
  for (size_t i = 0; i < rows.size(); ++i) {
    const live::GraphInfo::Resource& r = g.resources[rows[i]];
    const float y = origin.y + head + cell * float(i);
    list->AddText(ImVec2(origin.x, y), r.live ? text : grey, r.name.c_str());
    if (r.live)
      list->AddRectFilled(ImVec2(origin.x + names + cell * float(r.first), y + cell * 0.42f),
                          ImVec2(origin.x + names + cell * float(r.last + 1), y + cell * 0.58f),
                          IM_COL32(255, 255, 255, 40));
    for (size_t p = 0; p < g.passes.size(); ++p) {
      bool read = false, write = false;
      const live::GraphInfo::Use* use = find_use(g, p, rows[i], read, write);
      if (!use) continue;
      const ImVec2 low(origin.x + names + cell * float(p) + 2, y + 2), high(low.x + cell - 4, low.y + cell - 4);
      const ImU32 fade = g.passes[p].culled ? 0x50ffffffu : 0xffffffffu;
      if (read)
        list->AddRectFilled(low, write ? ImVec2(low.x + (high.x - low.x) / 2, high.y) : high, read_color & fade);
      if (write)
        list->AddRectFilled(read ? ImVec2(low.x + (high.x - low.x) / 2, low.y) : low, high, write_color & fade);
      // A letter, too: not by colour alone.
      const char* letter = read && write ? "" : read ? "r" : "w";
      list->AddText(ImVec2(low.x + 2, low.y - 1), IM_COL32(0, 0, 0, 255), letter);
      ImGui::SetCursorScreenPos(low);
      ImGui::PushID(int(p * 1000 + i));
      if (ImGui::InvisibleButton("use", ImVec2(high.x - low.x, high.y - low.y)) && !r.buffer)
        show_texture(editor, probe_of(g, *use));
      ui::note(fmt::format("graph.use.{}.{}", g.passes[p].label, r.name), read && write ? "rw" : read ? "r" : "w");
      if (ImGui::IsItemHovered()) point_at(editor, preview_after(editor, g.passes[p].label, r.name), true, false);
      if (ImGui::IsItemHovered())
        ImGui::SetTooltip("%s %s %s%s%s\n%s %s, %.2f MiB\nclick: look at it after this pass", g.passes[p].label.c_str(),
                          read && write ? "reads and writes"
                          : read        ? "reads"
                                        : "writes",
                          r.name.c_str(), use->slot.empty() ? "" : " as ", use->slot.c_str(), r.format.c_str(),
                          r.size.c_str(), double(r.bytes) / mib);
      ImGui::PopID();
    }
  }
  list->ChannelsMerge();
  ImGui::EndChild();
}

}  // namespace

void draw_graph_panel(Editor& editor) {
  const live::GraphInfo& g = editor.graph;
  const size_t culled = size_t(std::count_if(g.passes.begin(), g.passes.end(), [](const auto& p) { return p.culled; }));
  uint32_t barriers = 0;
  for (const live::GraphInfo::Pass& pass : g.passes) barriers += pass.barrier_count;
  ImGui::Text("%zu passes, %zu culled; %zu resources; %u barriers", g.passes.size(), culled, g.resources.size(),
              barriers);
  ui::note("graph.summary", fmt::format("{} passes {} barriers", g.passes.size(), barriers));
  ImGui::SameLine();
  ui::chip("graph.legend.read", "r read", read_color);
  ImGui::SameLine();
  ui::chip("graph.legend.write", "w write", write_color);
  ImGui::SameLine();
  ImGui::TextDisabled("(numbers: barriers before the pass)");
  if (!editor.plan_diff.empty()) {
    ImGui::SameLine();
    if (ui::button("graph.diff", "what the last change did", "Passes, resources and memory: before and after it"))
      ImGui::OpenPopup("plan diff");
    if (ImGui::BeginPopup("plan diff")) {
      ImGui::TextUnformatted(editor.plan_diff.c_str());
      ui::note("graph.diff.text", editor.plan_diff);
      ImGui::EndPopup();
    }
  }
  draw_grid(editor);
}

void draw_memory_panel(Editor& editor) {
  const live::GraphInfo& g = editor.graph;
  if (g.unaliased == 0) return;
  ImGui::Text(
      "transient memory: %.2f MiB placed of %.2f MiB; no placement needs less than %.2f MiB; sharing saves %.0f %%",
      double(g.placed) / mib, double(g.unaliased) / mib, double(g.max_live) / mib,
      100 * (1 - double(g.placed) / double(g.unaliased)));
  ui::note("memory.summary", fmt::format("{}", g.placed));
  const ImVec2 low = ImGui::GetCursorScreenPos();
  const ImVec2 size = ImGui::GetContentRegionAvail();
  const float height = std::max(size.y - 4, 40.0f);
  ImDrawList* list = ImGui::GetWindowDrawList();
  uint64_t total = 0;
  std::vector<uint64_t> start;
  for (const uint64_t heap : g.heaps) start.push_back(total), total += heap;
  if (total == 0 || g.passes.empty()) return;
  list->AddRectFilled(low, ImVec2(low.x + size.x, low.y + height), IM_COL32(24, 24, 28, 255));
  const float step = size.x / float(g.passes.size());
  for (size_t r = 0; r < g.resources.size(); ++r) {
    const live::GraphInfo::Resource& row = g.resources[r];
    if (row.heap < 0 || !row.live) continue;
    const double first = double(start[size_t(row.heap)] + row.offset) / double(total),
                 share = double(row.bytes) / double(total);
    const ImVec2 a(low.x + step * float(row.first), low.y + height * float(first));
    const ImVec2 b(low.x + step * float(row.last + 1) - 1,
                   std::max(low.y + height * float(first + share) - 1, a.y + 1));
    // Hues by the golden angle: neighbours differ.
    const ImVec4 c = ImColor::HSV(float(r) * 0.381966f - std::floor(float(r) * 0.381966f), 0.45f, 0.78f);
    list->AddRectFilled(a, b, ImGui::ColorConvertFloat4ToU32(c));
    if (b.y - a.y > ImGui::GetFontSize() && b.x - a.x > ImGui::GetFontSize() * 2) {
      list->PushClipRect(a, b, true);
      list->AddText(ImVec2(a.x + 2, a.y), IM_COL32(10, 10, 10, 255), row.name.c_str());
      list->PopClipRect();
    }
    ImGui::SetCursorScreenPos(a);
    ImGui::PushID(int(r));
    ImGui::InvisibleButton("bar", ImVec2(std::max(b.x - a.x, 1.0f), std::max(b.y - a.y, 1.0f)));
    ui::note("memory.bar." + row.name, fmt::format("{}", row.bytes));
    if (ImGui::IsItemHovered()) {
      std::string shared;
      for (const uint16_t other : row.alias_of) shared += "\n  bytes were " + g.resources[other].name + "'s";
      ImGui::SetTooltip("%s  %s %s\n%.2f MiB at %.2f MiB of heap %d\n%s to %s%s", row.name.c_str(), row.format.c_str(),
                        row.size.c_str(), double(row.bytes) / mib, double(row.offset) / mib, row.heap,
                        g.passes[row.first].name.c_str(), g.passes[row.last].name.c_str(), shared.c_str());
    }
    ImGui::PopID();
  }
}

}  // namespace nf::editor
