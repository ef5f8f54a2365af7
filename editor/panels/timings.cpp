// Times of the passes over a window of frames: a table with percentiles, and stacked bars of the last frames.
#include <algorithm>
#include <cmath>
#include <imgui.h>
#include <numeric>

#include "capture/statistics.h"
#include "panels/panels.h"
#include "ui/widgets.h"

namespace nf::editor {
namespace {

struct TimingRow {
  std::string name, description;
  float last = 0, share = 0;
  capture::Statistics s;
};

capture::Statistics statistics_of(const std::deque<float>& ms, size_t window) {
  std::vector<double> samples;
  for (size_t i = ms.size() - std::min(window, ms.size()); i < ms.size(); ++i)
    if (std::isfinite(ms[i])) samples.push_back(double(ms[i]));
  return capture::statistics(samples);
}

// A palette for eyes of all kinds: Okabe and Ito's eight.
constexpr ImU32 palette[] = {IM_COL32(86, 180, 233, 255),  IM_COL32(230, 159, 0, 255),  IM_COL32(0, 158, 115, 255),
                             IM_COL32(240, 228, 66, 255),  IM_COL32(0, 114, 178, 255),  IM_COL32(213, 94, 0, 255),
                             IM_COL32(204, 121, 167, 255), IM_COL32(170, 170, 170, 255)};

void draw_history(Editor& editor) {
  const TimingHistory& t = editor.timings;
  const float height = ImGui::GetFontSize() * 5, width = ImGui::GetContentRegionAvail().x;
  const ImVec2 low = ImGui::GetCursorScreenPos();
  ImGui::InvisibleButton("history", ImVec2(std::max(width, 1.0f), height));
  ui::note("timings.history");
  if (t.frame_ms.empty()) return;
  ImDrawList* list = ImGui::GetWindowDrawList();
  list->AddRectFilled(low, ImVec2(low.x + width, low.y + height), IM_COL32(24, 24, 28, 255));
  const size_t bars = std::min<size_t>(t.frame_ms.size(), 256), first = t.frame_ms.size() - bars;
  const float top = *std::max_element(t.frame_ms.begin() + long(first), t.frame_ms.end()), step = width / 256;
  for (size_t i = 0; i < bars; ++i) {
    float y = low.y + height;
    const float x = low.x + float(i) * step;
    for (size_t r = 0; r < t.rows.size(); ++r) {
      const float ms = t.rows[r].ms[first + i];
      if (!std::isfinite(ms)) continue;
      const float h = height * ms / std::max(top, 1e-6f);
      list->AddRectFilled(ImVec2(x, y - h), ImVec2(x + std::max(step - 0.5f, 1.0f), y),
                          palette[r % std::size(palette)]);
      y -= h;
    }
  }
  list->AddText(ImVec2(low.x + 4, low.y + 2), IM_COL32(230, 230, 230, 255), fmt::format("{:.1f} ms", top).c_str());
  if (ImGui::IsItemHovered()) {
    const size_t at = size_t(std::max((ImGui::GetIO().MousePos.x - low.x) / step, 0.0f));
    if (at < bars) {
      ImGui::BeginTooltip();
      ImGui::Text("frame %.2f ms", double(t.frame_ms[first + at]));
      for (const TimingHistory::Row& row : t.rows)
        if (const float ms = row.ms[first + at]; std::isfinite(ms) && ms > 0.01f * t.frame_ms[first + at])
          ImGui::Text("%s %.2f", row.name.c_str(), double(ms));
      ImGui::EndTooltip();
    }
  }
}

std::vector<TimingRow> make_rows(const TimingHistory& t, size_t window) {
  std::vector<TimingRow> rows;
  const capture::Statistics frame = statistics_of(t.frame_ms, window);
  for (const TimingHistory::Row& row : t.rows) {
    TimingRow out{.name = row.name, .description = row.description, .s = statistics_of(row.ms, window)};
    if (out.s.count == 0) continue;
    out.last = std::isfinite(row.ms.back()) ? row.ms.back() : 0;
    out.share = frame.median > 0 ? float(out.s.median / frame.median) : 0;
    rows.push_back(std::move(out));
  }
  return rows;
}

std::string row_text(const TimingRow& row, int column) {
  switch (column) {
    case 0:
      return row.name;
    case 1:
      return fmt::format("{:.3f}", row.last);
    case 2:
      return fmt::format("{:.3f}", row.s.median);
    case 3:
      return fmt::format("{:.3f}", row.s.p95);
    case 4:
      return fmt::format("{:.3f}", row.s.p99);
    case 5:
      return fmt::format("{:.3f}", row.s.max);
    default:
      return fmt::format("{:.1f} %", double(100 * row.share));
  }
}

void sort_rows(std::vector<TimingRow>& rows) {
  const ImGuiTableSortSpecs* specs = ImGui::TableGetSortSpecs();
  if (!specs || specs->SpecsCount == 0) return;
  const int column = specs->Specs[0].ColumnIndex;
  const bool down = specs->Specs[0].SortDirection == ImGuiSortDirection_Descending;
  const auto key = [&](const TimingRow& r) {
    return column == 1   ? double(r.last)
           : column == 2 ? r.s.median
           : column == 3 ? r.s.p95
           : column == 4 ? r.s.p99
           : column == 5 ? r.s.max
                         : double(r.share);
  };
  std::stable_sort(rows.begin(), rows.end(), [&](const TimingRow& a, const TimingRow& b) {
    if (column == 0) return down ? a.name > b.name : a.name < b.name;
    return down ? key(a) > key(b) : key(a) < key(b);
  });
}

void draw_delta(const TimingHistory& t, const std::string& name, const capture::Statistics& s) {
  const auto base = t.baseline.find(name);
  if (base == t.baseline.end()) return;
  const double delta = s.median - double(base->second);
  const bool noise = std::abs(delta) < 2 * s.mad;
  const std::string text = fmt::format(
      "{:+.3f}  {:+.1f} %{}", delta, base->second > 0 ? 100 * delta / double(base->second) : 0, noise ? "  noise" : "");
  if (noise)
    ImGui::TextDisabled("%s", text.c_str());
  else
    ImGui::TextUnformatted(text.c_str());
}

}  // namespace

bool TimingHistory::add(const live::Published& frame) {
  if (paused || frame.reduced || frame.passes.empty()) return false;
  if (frame.made_with.history != made_with.history || frame.made_with.size != made_with.size) clear();
  made_with = frame.made_with;
  size_t next = 0;  // the row behind the last pass's
  float left = frame.frame_ms;
  for (Row& row : rows) row.ms.push_back(NAN);
  capture::FrameSample sample{.frame = uint32_t(frame.number),
                              .submit_ns = frame.submit_ns,
                              .gpu_ms = double(frame.frame_ms),
                              .wall_ms = double(frame.wall_ms),
                              .cpu_ms = double(frame.record_ms)};
  for (const live::PassRow& pass : frame.passes) {
    auto row = std::find_if(rows.begin(), rows.end(), [&](const Row& r) { return r.name == pass.name; });
    if (row == rows.end())
      row = rows.insert(rows.begin() + long(next),
                        {pass.name, pass.description, std::deque<float>(frame_ms.size() + 1, NAN)});
    row->ms.back() = pass.ms;
    next = size_t(row - rows.begin()) + 1;
    left -= pass.ms;
    sample.passes.push_back({run.find_pass(pass.name, 1, pass.kind.c_str(), pass.description.c_str()),
                             double(pass.begin_ms), double(pass.ms), double(pass.record_ms)});
  }
  run.frames.push_back(std::move(sample));
  frame_ms.push_back(frame.frame_ms);
  wall_ms.push_back(frame.wall_ms);
  record_ms.push_back(frame.record_ms);
  left_ms.push_back(left);
  if (frame_ms.size() <= limit) return true;
  for (Row& row : rows) row.ms.pop_front();
  run.frames.erase(run.frames.begin());
  for (std::deque<float>* times : {&frame_ms, &wall_ms, &record_ms, &left_ms}) times->pop_front();
  std::erase_if(rows, [](const Row& r) {
    return std::none_of(r.ms.begin(), r.ms.end(), [](float x) { return std::isfinite(x); });
  });
  return true;
}

void TimingHistory::clear() {
  rows.clear();
  run = {};
  load = {};
  for (std::deque<float>* times : {&frame_ms, &wall_ms, &record_ms, &left_ms}) times->clear();
}

void draw_timings_panel(Editor& editor) {
  TimingHistory& t = editor.timings;
  ui::checkbox("timings.pause", "pause", t.paused, "Keep what is shown");
  ImGui::SameLine();
  if (ui::button("timings.reset", "reset")) t.clear();
  ImGui::SameLine();
  ImGui::SetNextItemWidth(ImGui::GetFontSize() * 7);
  ui::combo("timings.window", "", t.window, {"60 frames", "300 frames", "1000 frames"});
  ImGui::SameLine();
  if (ui::button(
          "timings.baseline", t.baseline.empty() ? "set baseline" : "new baseline",
          "Later times are shown against these medians; a difference below two median absolute deviations is noise")) {
    t.baseline.clear();
    for (const TimingRow& row : make_rows(t, size_t(timing_windows[t.window])))
      t.baseline[row.name] = float(row.s.median);
    t.baseline["frame"] = float(statistics_of(t.frame_ms, size_t(timing_windows[t.window])).median);
  }
  ImGui::SameLine();
  if (ui::button("timings.capture", editor.recording ? "stop and write" : "capture to files",
                 "JSON, CSV and a trace of so many frames; the renderer goes on until there are enough (Ctrl+T)"))
    editor.capture_asked = true;
  ImGui::SameLine();
  ImGui::SetNextItemWidth(ImGui::GetFontSize() * 6);
  int& most = editor.preferences.capture_frames;
  if (ImGui::InputInt("##frames", &most, 0)) most = std::clamp(most, 1, int(TimingHistory::limit));
  ui::note("timings.capture_frames", fmt::format("{}", most));
  ui::tooltip("Frames of a capture");
  ImGui::SameLine();
  if (editor.software) ui::chip("timings.software", "software device: CPU times", IM_COL32(240, 200, 90, 255));
  draw_history(editor);

  const size_t window = size_t(timing_windows[t.window]);
  std::vector<TimingRow> rows = make_rows(t, window);
  const capture::Statistics frame = statistics_of(t.frame_ms, window);
  const int columns = t.baseline.empty() ? 7 : 8;
  if (!ImGui::BeginTable("timings", columns,
                         ImGuiTableFlags_Sortable | ImGuiTableFlags_SortTristate | ImGuiTableFlags_RowBg |
                             ImGuiTableFlags_ScrollY | ImGuiTableFlags_BordersInnerV))
    return;
  ImGui::TableSetupScrollFreeze(0, 1);
  ImGui::TableSetupColumn("pass", ImGuiTableColumnFlags_WidthStretch | ImGuiTableColumnFlags_NoSort, 2.2f);
  for (const char* name : {"last ms", "median", "p95", "p99", "max", "share"})
    ImGui::TableSetupColumn(name, ImGuiTableColumnFlags_PreferSortDescending);
  if (columns == 8)
    ImGui::TableSetupColumn("against baseline", ImGuiTableColumnFlags_WidthStretch | ImGuiTableColumnFlags_NoSort,
                            1.6f);
  ImGui::TableHeadersRow();
  if (ImGui::TableGetSortSpecs() && ImGui::GetIO().MouseReleased[0]) ImGui::TableGetSortSpecs()->SpecsDirty = true;
  sort_rows(rows);
  for (const TimingRow& row : rows) {
    ImGui::TableNextRow();
    for (int c = 0; c < 7; ++c) {
      ImGui::TableNextColumn();
      if (c > 0) {
        ImGui::TextUnformatted(row_text(row, c).c_str());
        continue;
      }
      const std::optional<Preview> preview = preview_after(editor, row.name);
      const bool locked = preview && editor.locked_preview && editor.locked_preview->title == preview->title;
      const bool clicked = ImGui::Selectable(("##" + row.name).c_str(), locked, ImGuiSelectableFlags_SpanAllColumns);
      point_at(editor, preview, ImGui::IsItemHovered(), clicked);
      ui::tooltip(row.description);
      ImGui::SameLine();
      ImGui::TextUnformatted(row.name.c_str());
      ui::note("timings.row." + row.name, fmt::format("{:.3f}", row.s.median));
    }
    if (columns == 8) ImGui::TableNextColumn(), draw_delta(t, row.name, row.s);
  }
  const auto total = [&](const char* name, const char* help, double last, const capture::Statistics& s) {
    ImGui::TableNextRow();
    TimingRow row{.name = name,
                  .description = help,
                  .last = float(last),
                  .share = frame.median > 0 ? float(s.median / frame.median) : 0,
                  .s = s};
    for (int c = 0; c < 7; ++c) {
      ImGui::TableNextColumn();
      ImGui::TextDisabled("%s", row_text(row, c).c_str());
      if (c == 0) ui::note(std::string("timings.row.") + name, fmt::format("{:.3f}", s.median)), ui::tooltip(help);
    }
    if (columns == 8) ImGui::TableNextColumn(), draw_delta(t, name, s);
  };
  if (!t.frame_ms.empty()) {
    total("unattributed", "Of each frame's time, what no pass accounts for", double(t.left_ms.back()),
          statistics_of(t.left_ms, window));
    total("frame", "From the first pass's begin to the last one's end", double(t.frame_ms.back()), frame);
    total("wall", "From submission until the host knew that the frame was done", double(t.wall_ms.back()),
          statistics_of(t.wall_ms, window));
    total("record", "Planning and recording, on the CPU", double(t.record_ms.back()),
          statistics_of(t.record_ms, window));
  }
  total("UI", "This window's own frame, beside the scene's", double(editor.ui_ms),
        statistics_of(editor.ui_history, window));
  ImGui::EndTable();
}

}  // namespace nf::editor
