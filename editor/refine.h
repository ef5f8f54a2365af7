// Keeps the path tracer at the view that the window shows, and the picture's error against it up to date.
#pragma once

#include "editor.h"

namespace nf::editor {

class Refiner {
 public:
  // Each frame of the interface.
  void update(Editor& editor);
  // The scene that was asked for (live::CommandKind::CopyScene).
  void take_scene(Editor& editor, std::unique_ptr<scene::Scene> scene);
  // A frame's layer to compare.
  void compare(Editor& editor, live::Pixels&& pixels);

 private:
  void show(Editor& editor);
  LiveReference tracer_;
  bool asked_ = false, running_ = false;
  uint64_t scene_ = 0, lights_ = 0;
  scene::Camera camera_;
  glm::uvec2 size_{0};
  std::string settings_;  // what of the settings the tracer heeds, as text
  image::Image compared_;
  std::string compared_name_;
};

}  // namespace nf::editor
