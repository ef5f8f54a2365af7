#include "ui/script.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>
#include <fstream>
#include <optional>
#include <sstream>

#include "core/error.h"

namespace nf::editor::ui {
namespace {

using nlohmann::json;

// The longest key that the path begins with, at each level.
const json* find(const json& state, std::string_view path) {
  if (path.empty()) return &state;
  if (state.is_array()) {
    const size_t dot = std::min(path.find('.'), path.size());
    const size_t index = size_t(std::atoi(std::string(path.substr(0, dot)).c_str()));
    return index < state.size() ? find(state[index], path.substr(std::min(dot + 1, path.size()))) : nullptr;
  }
  if (!state.is_object()) return nullptr;
  for (size_t end = path.size(); end != std::string_view::npos && end > 0; end = path.rfind('.', end - 1)) {
    const auto member = state.find(std::string(path.substr(0, end)));
    if (member == state.end()) continue;
    if (const json* found = find(*member, path.substr(std::min(end + 1, path.size())))) return found;
  }
  return nullptr;
}

std::string trim(const std::string& text) {
  const size_t first = text.find_first_not_of(' '), last = text.find_last_not_of(' ');
  return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

json literal(const std::string& text, const std::map<std::string, json>& kept) {
  if (text.starts_with('$')) {
    const auto value = kept.find(text.substr(1));
    if (value == kept.end()) fail(Exit::Input, "nothing was kept as '{}'", text);
    return value->second;
  }
  const json value = json::parse(text, nullptr, false);
  return value.is_discarded() ? json(text) : value;
}

// Numbers written as text (values of widgets) compare as numbers with numbers.
std::optional<double> number(const json& value) {
  if (value.is_number()) return value.get<double>();
  if (!value.is_string()) return std::nullopt;
  const std::string text = value;
  char* end = nullptr;
  const double x = std::strtod(text.c_str(), &end);
  return end == text.c_str() || *end ? std::nullopt : std::optional(x);
}

bool compare(const json& a, const std::string& op, const json& b) {
  if (op == "contains")
    return a.is_string() && b.is_string() && a.get<std::string>().find(b.get<std::string>()) != std::string::npos;
  const std::optional<double> x = number(a), y = number(b);
  if (x && y) {
    if (op == "==") return *x == *y;
    if (op == "!=") return *x != *y;
    return op == "<" ? *x < *y : op == "<=" ? *x <= *y : op == ">" ? *x > *y : *x >= *y;
  }
  // A widget's value is text: "true" is what true is.
  if (a.is_string() && !b.is_string()) return compare(a, op, json(b.dump()));
  if (op == "==") return a == b;
  if (op == "!=") return a != b;
  return false;
}

}  // namespace

bool holds(const std::string& condition, const json& state, const std::map<std::string, json>& kept) {
  for (size_t at = 0; at <= condition.size();) {
    const size_t end = std::min(condition.find("&&", at), condition.size());
    const std::string one = trim(condition.substr(at, end - at));
    size_t place = std::string::npos;
    std::string op;
    for (const char* candidate : {"==", "!=", "<=", ">=", "<", ">", " contains "})
      if (place = one.find(candidate); place != std::string::npos) {
        op = candidate;
        break;
      }
    if (place == std::string::npos)
      fail(Exit::Input, "'{}' is no condition: write `path op value` with == != < <= > >= or contains", one);
    const json* value = find(state, trim(one.substr(0, place)));
    if (!compare(value ? *value : json(), trim(op), literal(trim(one.substr(place + op.size())), kept))) return false;
    at = end + 2;
  }
  return true;
}

Script::Script(const std::string& path, Host host) : host_(std::move(host)), path_(path) {
  std::ifstream in(path);
  if (!in) fail(Exit::Input, "cannot read the script '{}': no such file", path);
  std::string text;
  for (int number = 1; std::getline(in, text); ++number) {
    if (trim(text).empty() || trim(text).starts_with('#')) continue;
    json line = json::parse(text, nullptr, false);
    if (!line.is_object()) fail(Exit::Input, "bad script '{}', line {}: each line is one JSON object", path, number);
    lines_.emplace_back(number, std::move(line));
  }
}

void Script::fail_line(const std::string& why) {
  failure_ = fmt::format("{}:{}: {}: {}", path_, lines_[next_].first, lines_[next_].second.dump(), why);
}

bool Script::step(double now, const json& state, InputQueue& input) {
  while (failure_.empty() && next_ < lines_.size()) {
    if (!input.empty()) return false;
    if (settle_ > 0) {
      --settle_;
      return false;
    }
    if (since_ < 0) since_ = now;
    const json& line = lines_[next_].second;
    bool done = false;
    try {
      done = run(line, state, input, now);
    } catch (const Error& e) {
      fail_line(e.what());
    } catch (const json::exception& e) {
      fail_line(e.what());
    }
    if (!failure_.empty()) break;
    if (!done) {
      if (now - since_ > line.value("timeout", 60.0)) fail_line("it did not come to that in time");
      return !failure_.empty();
    }
    ++next_;
    since_ = -1;
  }
  return true;
}

// True when the line is done with.
bool Script::run(const json& line, const json& state, InputQueue& input, double) {
  const auto place = [&](const std::string& id, const json& at) -> std::optional<std::pair<float, float>> {
    const auto widget = state.at("widgets").find(id);
    if (widget == state.at("widgets").end() || !widget->at("visible").get<bool>() || !widget->at("enabled").get<bool>())
      return std::nullopt;
    const json& rect = widget->at("rect");
    const float x = at.is_array() ? at.at(0).get<float>() : 0.5f, y = at.is_array() ? at.at(1).get<float>() : 0.5f;
    return std::pair(rect.at(0).get<float>() + rect.at(2).get<float>() * x,
                     rect.at(1).get<float>() + rect.at(3).get<float>() * y);
  };
  const json at = line.value("at", json());
  if (line.contains("wait")) return holds(line.at("wait"), state, kept_);
  if (line.contains("expect")) {
    if (!holds(line.at("expect"), state, kept_)) fail_line("it is not so");
    return true;
  }
  if (line.contains("keep")) {
    const json* value = find(state, line.at("of").get<std::string>());
    if (!value) fail_line("there is no such value");
    if (value) kept_[line.at("keep")] = *value;
    return true;
  }
  if (line.contains("tell")) {
    const json* value = find(state, line.at("of").get<std::string>());
    fmt::print("{}: {}\n", line.at("tell").get<std::string>(), value ? value->dump() : "null");
    return true;
  }
  settle_ = line.value("frames", 3);
  if (line.contains("click") || line.contains("drag") || line.contains("hover")) {
    const char* what = line.contains("click") ? "click" : line.contains("drag") ? "drag" : "hover";
    const auto p = place(line.at(what), at);
    if (!p) return false;  // not there yet
    const int button = line.value("button", 0);
    input.push({.kind = InputKind::Move, .x = p->first, .y = p->second});
    if (line.contains("hover")) return true;
    const auto modifier = [&](bool down) {
      if (line.value("ctrl", false))
        input.push({.kind = InputKind::Key, .code = GLFW_KEY_LEFT_CONTROL, .down = down, .mods = mod_ctrl});
      if (line.value("alt", false))
        input.push({.kind = InputKind::Key, .code = GLFW_KEY_LEFT_ALT, .down = down, .mods = mod_alt});
    };
    modifier(true);
    for (int n = 0; n < line.value("count", 1); ++n) {
      input.push({.kind = InputKind::Button, .code = button, .down = true});
      // Keys that go down and up while the button is held.
      if (line.contains("holding")) {
        const Chord chord = parse_chord(line.at("holding"));
        if (chord.mods & mod_ctrl)
          input.push({.kind = InputKind::Key, .code = GLFW_KEY_LEFT_CONTROL, .down = true, .mods = mod_ctrl});
        for (const bool down : {true, false})
          input.push({.kind = InputKind::Key, .code = chord.key, .down = down, .mods = chord.mods});
        if (chord.mods & mod_ctrl) input.push({.kind = InputKind::Key, .code = GLFW_KEY_LEFT_CONTROL, .down = false});
      }
      if (line.contains("drag")) {
        const float dx = line.at("by").at(0), dy = line.at("by").at(1);
        for (int i = 1; i <= 4; ++i)
          input.push({.kind = InputKind::Move, .x = p->first + dx * float(i) / 4, .y = p->second + dy * float(i) / 4});
      }
      input.push({.kind = InputKind::Button, .code = button, .down = false});
    }
    modifier(false);
    // Away at once, as hands are: the click must count all the same.
    if (line.value("leave", false)) input.push({.kind = InputKind::Move, .x = 1, .y = 1});
    return true;
  }
  if (line.contains("key")) {
    const Chord chord = parse_chord(line.at("key"));
    input.push({.kind = InputKind::Key, .code = chord.key, .down = true, .mods = chord.mods});
    input.push({.kind = InputKind::Key, .code = chord.key, .down = false, .mods = chord.mods});
    return true;
  }
  if (line.contains("type")) {
    for (const char c : line.at("type").get<std::string>())
      input.push({.kind = InputKind::Char, .code = static_cast<unsigned char>(c)});
    return true;
  }
  if (line.contains("wheel")) {
    const auto p = place(line.at("over"), at);
    if (!p) return false;
    input.push({.kind = InputKind::Move, .x = p->first, .y = p->second});
    input.push({.kind = InputKind::Wheel, .y = line.at("wheel").get<float>()});
    return true;
  }
  if (line.contains("drop")) return input.push({.kind = InputKind::Drop, .text = line.at("drop")}), true;
  if (line.contains("resize"))
    return input.push({.kind = InputKind::Resize, .x = line.at("resize").at(0), .y = line.at("resize").at(1)}), true;
  if (line.contains("display_scale"))
    return input.push({.kind = InputKind::Scale, .x = line.at("display_scale")}), true;
  if (line.contains("screenshot")) {
    glm::ivec4 part{0, 0, state.at("window").at(0).get<int>(), state.at("window").at(1).get<int>()};
    if (line.contains("of")) {
      const auto widget = state.at("widgets").find(line.at("of").get<std::string>());
      if (widget == state.at("widgets").end()) return false;  // not there yet
      const json& rect = widget->at("rect");
      for (int i = 0; i < 4; ++i) part[i] = int(rect.at(size_t(i)).get<float>());
      if (line.contains("above")) part[3] = int(float(part[3]) * line.at("above").get<float>());
    }
    return host_.screenshot(line.at("screenshot"), part), true;
  }
  if (line.contains("drop_barrier")) return host_.drop_barrier(), true;
  if (line.contains("lose_device")) return host_.lose_device(line.at("lose_device")), true;
  if (line.contains("quit")) return host_.quit(), true;
  if (line.contains("edit")) {
    const std::string file = line.at("edit"), from = line.at("replace").at(0), to = line.at("replace").at(1);
    std::ifstream in(file);
    std::stringstream text;
    text << in.rdbuf();
    std::string all = text.str();
    const size_t found = all.find(from);
    if (!in || found == std::string::npos) {
      fail_line("the file has no such text");
      return true;
    }
    all.replace(found, from.size(), to);
    std::ofstream(file) << all;
    return true;
  }
  fail(Exit::Input, "unknown step");
}

}  // namespace nf::editor::ui
