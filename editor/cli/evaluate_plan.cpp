// What is to be evaluated: lists of the command line into places and contenders.
#include <algorithm>

#include "cli/evaluate.h"
#include "cli/paper_spec.h"

namespace nf::editor {
namespace {

namespace fs = std::filesystem;

constexpr const char* forms[] = {"radiometric", "paper"};

bool has_form(const passes::Technique& technique, std::string_view mode) {
  return mode != "paper" || !technique.paper_mode.empty();
}

// "vbgi", "vbgi:paper", or "all": every technique in every form it has.
std::vector<std::pair<std::string, std::string>> parse_techniques(const std::string& list) {
  std::vector<std::pair<std::string, std::string>> wanted;
  if (list == "all") {
    for (const passes::Technique& t : passes::techniques())
      for (const char* mode : forms)
        if (has_form(t, mode)) wanted.emplace_back(t.id, mode);
    return wanted;
  }
  for (const std::string& part : split_list(list)) {
    const size_t colon = part.find(':');
    const std::string id = part.substr(0, colon), mode = colon == std::string::npos ? forms[0] : part.substr(colon + 1);
    const passes::Technique& technique = passes::find_technique(id);
    if (std::find(std::begin(forms), std::end(forms), mode) == std::end(forms) || !has_form(technique, mode))
      fail(Exit::Usage, "--techniques: {} has no form '{}'; write {}{}", id, mode, id,
           has_form(technique, "paper") ? fmt::format(" or {}:paper", id) : "");
    if (std::find(wanted.begin(), wanted.end(), std::pair(id, mode)) == wanted.end()) wanted.emplace_back(id, mode);
  }
  if (wanted.empty()) fail(Exit::Usage, "--techniques: the list is empty; write ids, or all");
  return wanted;
}

// Modes of resolution.gi; one without a name where none is asked for.
std::vector<std::string> parse_resolutions(const std::string& list) {
  std::vector<std::string> known;
  for (const Param& param : passes::ResolutionParams::table().params)
    for (int mode = 0; std::string_view(param.name) == "gi" && mode <= int(param.max); ++mode)
      known.push_back(params::choice_name(param, mode));
  if (list == "all") return known;
  const std::vector<std::string> wanted = split_list(list);
  for (const std::string& name : wanted)
    if (std::find(known.begin(), known.end(), name) == known.end())
      fail(Exit::Usage, "--resolutions: there is no '{}'; write all, or some of {}", name, fmt::join(known, ","));
  if (wanted.empty()) return {""};
  return wanted;
}

}  // namespace

std::vector<Place> parse_places(const EvaluateOptions& o) {
  std::vector<Place> places;
  for (const std::string& argument : o.scenes) {
    const size_t at = argument.rfind('@');
    Place place{argument.substr(0, at), at == std::string::npos ? o.view : argument.substr(at + 1), ""};
    if (!fs::is_regular_file(place.scene)) fail(Exit::Input, "cannot read the scene '{}': no such file", place.scene);
    place.label = fs::path(place.scene).stem().string();
    const std::string view =
        fs::path(place.view).extension() == ".json" ? fs::path(place.view).stem().string() : place.view;
    if (!view.empty()) place.label += "@" + view;
    for (const Place& other : places)
      if (other.label == place.label)
        fail(Exit::Usage, "'{}' is there twice: give every scene and view once", argument);
    places.push_back(place);
  }
  return places;
}

std::vector<Contender> parse_contenders(EvaluateOptions& o) {
  const auto techniques = parse_techniques(o.techniques);
  std::vector<std::string> presets;
  for (const std::string& name : split_list(o.presets)) {
    if (name == "default" || fs::path(name).extension() == ".json" || fs::is_regular_file(name))
      presets.push_back(name);
    else
      for (const fs::path& preset : find_presets(name)) presets.push_back(preset);
  }
  if (presets.empty()) presets.emplace_back("default");
  std::vector<Contender> contenders;
  const std::vector<std::string> resolutions = parse_resolutions(o.resolutions);
  const auto add = [&](const std::string& preset, const std::string& technique, const std::string& mode) {
    CommonOptions one = o;
    one.preset = preset == "default" ? "" : preset;
    one.technique = technique;
    one.mode = mode;
    one.size_given = one.seed_given = one.view_given = true;
    one.technique_given = one.mode_given = !technique.empty();
    Contender c{.preset = one.preset, .settings = make_settings(one)};
    c.technique = c.settings.technique->id;
    c.mode = one.mode;
    c.label = c.technique;
    if (c.mode == "paper") c.label += ":paper";
    if (!c.preset.empty()) c.label += "+" + fs::path(c.preset).stem().string();
    const std::string label = c.label;
    for (const std::string& resolution : resolutions) {
      if (!resolution.empty()) {
        params::assign(c.settings.blocks(), "resolution.gi=" + resolution);
        c.resolution = resolution;
        c.label = label + "@" + resolution;
      }
      const auto same = [&](const Contender& other) { return other.label == c.label; };
      if (std::none_of(contenders.begin(), contenders.end(), same)) contenders.push_back(c);
    }
  };
  for (const std::string& preset : presets) {
    bool names_technique = false;
    if (preset != "default") {
      // A preset that names its technique is one contender, whatever --techniques says.
      CommonOptions probe;
      probe.preset = preset;
      make_settings(probe);
      names_technique = !probe.technique.empty();
    }
    if (names_technique) {
      add(preset, "", forms[0]);
      continue;
    }
    for (const auto& [technique, mode] : techniques) add(preset, technique, mode);
  }
  return contenders;
}

std::span<const Quantity> quantities() {
  static constexpr Quantity rows[] = {
      {"visibility", "visibility", "visibility", "visibility", "visibility", false, false},
      {"gi_1", "gi, 1 bounce", "gi_raw", "gi_1", "gi", true, false},
      {"gi_n", "gi, N bounces", "gi_raw", "gi_n", "gi", true, true},
      {"ambient", "ambient colour", "ambient", "ambient", "ambient", true, false},
  };
  return rows;
}

}  // namespace nf::editor
