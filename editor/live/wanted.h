// What the window asks of the renderer: one value, of which only the newest counts, and commands, each of which is
// carried out. Nothing here is shared: values are copied through the mailbox (worker.h).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "frame.h"
#include "scene/view.h"

namespace nf::editor::live {

struct SceneLights {
  std::vector<scene::DirectionalLight> directional;
  std::vector<scene::PunctualLight> punctual;
  glm::vec3 environment{0};  // radiance of a constant environment; others stay as they are
};

// A resource of the frame as it is before or after a pass.
struct ProbeWanted {
  std::string pass, resource;  // as graph::pass_label and graph::resource_name have them
  bool before = false;
  uint8_t mip = 0, layer = 0;
  bool operator==(const ProbeWanted&) const = default;
};

struct Wanted {
  // Grow when something below changed: the picture anew, and the history with it (parameters, lights; not the camera).
  uint64_t revision = 0, history = 0, lights_revision = 0;
  uint64_t scene = 0;  // SceneInfo::serial of the scene that camera and lights are meant for
  passes::FrameSettings settings;
  bool bare = false;  // reconstruction is off in `settings`, whatever the document says: frames are averaged instead
  scene::Camera camera;
  SceneLights lights;
  glm::uvec2 size{1};
  uint32_t seed = 1;
  std::string layer;       // an AOV shown in place of the picture; "" = none
  uint32_t settle = 64;    // frames after which a still picture is done
  bool moving = false;     // someone is moving something: the next picture matters more than this one
  bool reduced = false;    // `size` is smaller than that of the still picture, because of that
  bool paused = false;     // no frame, but of the same picture to look into
  bool playing = false;    // the scene's clock runs
  double step = 1.0 / 60;  // seconds a frame; 0 = as the wall clock
  // Frozen: histories stay as the last frame left them; noise and jitter are the last frame's; what is outside this
  // camera's view is not drawn.
  bool hold_history = false, hold_noise = false;
  std::optional<scene::Camera> culling_camera;
  uint64_t steps = 0;        // grows: one step of a stopped clock
  uint64_t pick_serial = 0;  // grows: read every layer at `pick`
  glm::uvec2 pick{0};        // pixel of `size`
  std::optional<ProbeWanted> probe;
  std::optional<glm::uvec2> inspect;  // pixel of `size` that the technique takes apart, with each frame
  std::vector<std::string> layers;    // whose floats come along with each frame; "" is the final radiance
};

enum class CommandKind : uint8_t {
  LoadScene,
  LoadEnvironment,
  SaveLayers,
  CopyScene,
  ReloadShaders,
  Restart,
  LoseDevice,
  DropBarrier  // the next frame is recorded without one: the validation layer has something to say
};
struct Command {
  CommandKind kind;
  std::string path;
  std::string view;                // LoadScene: as --view has it
  std::optional<scene::View> lit;  // LoadScene: lights and camera, after that
};

}  // namespace nf::editor::live
