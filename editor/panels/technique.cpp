// Which technique, in which form, with which parameters.
#include <algorithm>
#include <filesystem>
#include <imgui.h>

#include "gi/param_sources.h"
#include "panels/panels.h"
#include "ui/widgets.h"

namespace nf::editor {
namespace {

bool matches(const std::string& search, const ParamBlock& block, const Param& row) {
  if (search.empty()) return true;
  const auto lower = [](std::string text) {
    std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return char(std::tolower(c)); });
    return text;
  };
  return lower(fmt::format("{}.{} {} {}", block.table->prefix, row.name, row.help, row.unit)).find(lower(search)) !=
         std::string::npos;
}

const char* title_of(const ParamTable& table, const passes::Technique& technique) {
  const std::string_view prefix = table.prefix;
  if (prefix == technique.id) return technique.name;
  if (prefix == "gi") return "Shared by all techniques";
  if (prefix == "material") return "Materials";
  if (prefix == "lights") return "Lights";
  if (prefix == "shadow") return "Shadows";
  if (prefix == "feedback") return "Multi-bounce feedback";
  if (prefix == "resolution") return "Resolution";
  if (prefix == "temporal") return "Temporal accumulation";
  if (prefix == "denoise") return "Denoise";
  if (prefix == "taa") return "Temporal anti-aliasing";
  if (prefix == "tonemap") return "Tone mapping";
  if (prefix == "debug") return "Looking for faults";
  return table.prefix;
}

void draw_block(Editor& editor, const ParamBlock& block) {
  Document& document = editor.document;
  const std::string_view prefix = block.table->prefix;
  bool any = false, changed = false;
  for (const Param& row : block.table->params) {
    const bool different = ui::is_changed(block, row);
    changed |= different;
    any |= matches(editor.search, block, row) && (!editor.changed_only || different);
  }
  if (!any) return;
  const bool main = prefix == document.settings.technique->id || prefix == "gi";
  const bool filtered = !editor.search.empty() || editor.changed_only;
  if (filtered) ImGui::SetNextItemOpen(true);
  const std::string title =
      fmt::format("{}{}###{}", title_of(*block.table, *document.settings.technique), changed ? " *" : "", prefix);
  const bool open = ImGui::CollapsingHeader(title.c_str(), main ? ImGuiTreeNodeFlags_DefaultOpen : 0);
  ui::note(fmt::format("technique.section.{}", prefix), open ? "open" : "closed");
  if (!open) return;
  for (const Param& row : block.table->params)
    if (matches(editor.search, block, row) && (!editor.changed_only || ui::is_changed(block, row)))
      ui::param(block, row, passes::param_source(block.table->prefix, row.name));
}

}  // namespace

void draw_technique_panel(Editor& editor) {
  passes::FrameSettings& settings = editor.document.settings;
  const auto techniques = passes::techniques();
  std::vector<std::string> names;
  int index = 0;
  for (const passes::Technique& t : techniques) {
    if (&t == settings.technique) index = int(names.size());
    names.push_back(t.id);
  }
  ImGui::SetNextItemWidth(-FLT_MIN);
  if (ui::combo("technique.combo", "", index, names)) settings.technique = &techniques[size_t(index)];
  ui::tooltip("GI technique (N, Shift+N)");
  ImGui::PushTextWrapPos(0);
  ImGui::TextUnformatted(settings.technique->name);
  ImGui::TextDisabled("%s", settings.technique->paper);
  ImGui::PopTextWrapPos();

  if (!settings.technique->paper_mode.empty()) {
    int mode = is_paper_mode(settings) ? 1 : 0;
    ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x * 0.54f);
    if (ui::combo("technique.mode", "mode", mode, {"radiometric", "paper"})) set_mode(settings, mode == 1);
    ui::tooltip("radiometric: with the errata mended. paper: as printed.");
  }
  std::vector<std::string> presets = {"preset ..."}, files;
  const std::filesystem::path folder = editor.preset_folder;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error))
    if (entry.path().extension() == ".json") files.push_back(entry.path().string());
  std::sort(files.begin(), files.end());
  for (const std::string& file : files) presets.push_back(std::filesystem::path(file).stem().string());
  int chosen = 0;
  ImGui::SetNextItemWidth(-FLT_MIN);
  if (ui::combo("technique.preset", "", chosen, presets) && chosen > 0)
    editor.dropped.push_back(files[size_t(chosen - 1)]);
  ui::tooltip("Presets that follow others' published formulas; Ctrl+S saves yours, Ctrl+O or a drop opens one");

  ImGui::Separator();
  const ImGuiStyle& style = ImGui::GetStyle();
  const float box = ImGui::GetFrameHeight() + style.ItemInnerSpacing.x + ImGui::CalcTextSize("changed").x;
  ImGui::SetNextItemWidth(std::max(ImGui::GetContentRegionAvail().x - box - style.ItemSpacing.x, 1.0f));
  ui::text_input("technique.search", "search parameters", editor.search);
  ImGui::SameLine();
  ui::checkbox("technique.changed_only", "changed", editor.changed_only, "Show only what differs from its default");
  if (ui::button("technique.reset", "Reset technique", "This technique's and the shared parameters at their defaults",
                 true))
    reset_params(settings);

  ImGui::BeginChild("parameters");
  // The technique's own block first, then what all share, then the frame's; other techniques' are not shown.
  const ParamBlock own = settings.technique->params(settings.gi);
  if (own.table) draw_block(editor, own);
  for (const ParamBlock& block : settings.blocks()) {
    const bool of_technique = std::any_of(techniques.begin(), techniques.end(), [&](const passes::Technique& t) {
      return std::string_view(t.id) == block.table->prefix;
    });
    if (!of_technique) draw_block(editor, block);
  }
  ImGui::EndChild();
}

}  // namespace nf::editor
