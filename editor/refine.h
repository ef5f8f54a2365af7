// Keeps the path tracer at the view that the window shows, and the picture's error against it up to date.
#pragma once

#include <span>

#include "editor.h"

namespace nf::editor {

// What the error can be split of: as `nearfield evaluate` has it.
struct SplitQuantity {
  const char *name, *test, *truth, *same;
};
std::span<const SplitQuantity> split_quantities();

// Another text for another scene: file, lights, environment, time of the clock.
std::string scene_key(const Editor& editor);

class Refiner {
 public:
  // Each frame of the interface.
  void update(Editor& editor);
  // The scene that was asked for (live::CommandKind::CopyScene).
  void take_scene(Editor& editor, std::unique_ptr<scene::Scene> scene);
  // What came of `wanted_layers` with a frame; moved out.
  void take_layers(Editor& editor, live::Published& frame);
  // The picture that is shown became A: what the error is taken of is kept with it.
  void keep_a(Editor& editor);

 private:
  void show(Editor& editor);
  void compare(Editor& editor, image::Layer&& layer);
  void judge_a(Editor& editor);
  void update_split(Editor& editor);
  void show_split(Editor& editor);
  LiveReference tracer_;
  bool asked_ = false, running_ = false;
  float peak_distance_ = 0;          // of the scene taken last
  std::string scene_, asked_scene_;  // scene_key() of what the tracer has, and of what was asked for
  scene::Camera camera_;
  glm::uvec2 size_{0};
  std::string settings_;  // what of the settings the tracer heeds, as text
  image::Image compared_;
  std::string compared_name_;
  uint64_t compared_frame_ = 0, compared_revision_ = 0;  // that it is of
  // What A is, as `compared_`.
  struct {
    image::Image image;
    std::string layer, scene;
    scene::Camera camera;
  } kept_;
  // The error's parts.
  LiveSplit split_;
  bool splitting_ = false;  // or waiting for a frame to begin with
  std::unique_ptr<scene::Scene> split_scene_;
  bool split_asked_ = false;  // for a copy of the scene
  // As text: what the tracer and all of it were begun with, the scene it has, and the one that was asked for.
  std::string split_truth_, split_view_, split_has_, split_copied_;
};

}  // namespace nf::editor
