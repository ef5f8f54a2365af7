// Drives the editor from a file: JSON lines that press, drag, type, wait and check, through the same input queue as a
// window's events. Positions are widgets' ids (widgets.h), never coordinates.
//
//   {"wait": "scene_frames >= 1"}             until it is true, "timeout" seconds at most (default 60)
//   {"click": "technique.combo"}              "button": 1 for the right one; "at": [x, y] in shares of the widget
//   {"drag": "viewport.wipe", "by": [80, 0]}  pixels; "ctrl", "alt": true; "holding": "ctrl+s", while the button is
//   down
//   {"hover": id}, {"wheel": 2, "over": id}, {"type": "text"}, {"key": "ctrl+z"}
//   {"expect": "params.gi.radius == 2"}       false ends the script with a failure
//   {"keep": "before", "of": "picture_hash"}  later: {"expect": "picture_hash != $before"}
//   {"tell": "first picture", "of": "seconds"}  one line on stdout; `seconds` are those since the start
//   {"drop": path}, {"resize": [w, h]}, {"display_scale": 2}
//   {"screenshot": path}                      "of": only what is within this widget, "above": a share of its height
//   {"edit": path, "replace": [from, to]}     changes a file, as another program would
//   {"drop_barrier": true}                    the next frame lacks one: validation has something to say
//   {"lose_device": "renderer"}, {"lose_device": "window"}, {"quit": true}
//
// Conditions are `path op value`, joined by `&&`; a path's parts are keys of the state, which may hold dots.
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "ui/input.h"

namespace nf::editor::ui {

// Throws nf::Error (Exit::Input) for a condition that cannot be read. A path that is not there reads as null.
bool holds(const std::string& condition, const nlohmann::json& state,
           const std::map<std::string, nlohmann::json>& kept);

class Script {
 public:
  // What the script asks of the program besides input.
  struct Host {
    std::function<void(const std::string& path, glm::ivec4 part)> screenshot;  // x, y, width, height
    std::function<void(const std::string& whose)> lose_device;
    std::function<void()> drop_barrier, quit;
  };
  // Throws nf::Error (Exit::Input) naming the line that is wrong.
  Script(const std::string& path, Host host);

  // Before each frame of the user interface, with what the last one left; `now` in seconds. True when there is no more.
  bool step(double now, const nlohmann::json& state, InputQueue& input);
  // What failed; empty: nothing.
  const std::string& failure() const { return failure_; }

 private:
  bool run(const nlohmann::json& line, const nlohmann::json& state, InputQueue& input, double now);
  void fail_line(const std::string& why);
  Host host_;
  std::string path_, failure_;
  std::vector<std::pair<int, nlohmann::json>> lines_;
  size_t next_ = 0;
  int settle_ = 0;  // frames to let pass, so that what was done shows in the state
  double since_ = -1;
  std::map<std::string, nlohmann::json> kept_;
};

}  // namespace nf::editor::ui
