// What the renderer tells the window: the newest frame, and events in their order.
#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "gpu/memory.h"
#include "gpu/reload.h"
#include "live/wanted.h"

namespace nf::editor::live {

struct SceneInfo {
  uint64_t serial = 0;  // grows with each scene
  std::string path;
  std::vector<scene::Camera> cameras;
  scene::Camera start;  // the one to begin with
  scene::Bounds bounds;
  uint64_t triangles = 0;
  size_t instances = 0, materials = 0, textures = 0, joints = 0;
  SceneLights lights, own_lights;  // as they are now; as the file has them
  scene::Environment environment;  // without the map's texels
  bool own_environment = true;     // the file's
  std::vector<std::string> clips;
  float duration = 0;  // seconds, of the longest clip
};

struct PassRow {
  std::string name, description, kind;
  float ms = 0, record_ms = 0, begin_ms = 0;
};

// The graph and its plan, as the panels show them.
struct GraphInfo {
  struct Pass {
    std::string name, label;  // times go by name; several shadow maps' passes share one: "name", "name #2"
    std::string description, kind;
    bool culled = false;
    std::string barriers;  // a line each
    uint32_t barrier_count = 0;
  };
  struct Resource {
    std::string name, format, size;
    uint64_t bytes = 0, offset = 0;
    int32_t heap = -1;
    uint32_t first = 0, last = 0;  // rows of `passes`
    bool live = false, buffer = false, history = false, imported = false;
    uint32_t mips = 1, layers = 1;
    std::vector<uint16_t> alias_of;
  };
  struct Use {
    uint32_t pass = 0, resource = 0;
    bool read = false, write = false;
    uint8_t mip = 0, layer = 0;  // the first of those it touches
    std::string slot;
  };
  std::vector<Pass> passes;  // in the order they run; culled ones at their declared place
  std::vector<Resource> resources;
  std::vector<Use> uses;
  std::vector<uint64_t> heaps;  // bytes
  uint64_t placed = 0, max_live = 0, unaliased = 0;
  std::string diff;  // against the plan before
};

// What a frame was made with: the window may want something else by the time it is seen.
struct MadeWith {
  passes::FrameSettings settings;
  scene::Camera camera;
  glm::uvec2 size{0};
  uint32_t seed = 1;
  uint64_t history = 0;  // of the Wanted
  size_t lights = 0;
};

struct LayerValue {
  std::string name, channels;
  std::vector<float> values;
};
// An image of the frame where it covers a pixel of the picture, as its last pass of the frame leaves it.
struct ImageValue {
  std::string name, format, pass;  // as the graph has them; the pass that wrote it last
  glm::uvec2 size{0}, texel{0};    // of the mip
  uint32_t mip = 0, mips = 1, layer = 0, layers = 1;
  bool of_view = true;            // else no texel of it is the pixel's
  std::vector<float> values;      // or
  std::vector<uint32_t> numbers;  // what is stored in integer formats
  std::string meaning;            // of the number, and what it stands for
  std::vector<float> unpacked;
};
struct Picked {
  uint64_t serial = 0;
  glm::uvec2 pixel{0};
  std::vector<LayerValue> layers;
  std::vector<ImageValue> images;
  MadeWith made_with;
};

struct Pixels {
  glm::uvec2 size{0};
  std::vector<uint8_t> rgba;              // a picture
  std::vector<float> floats;              // or four floats a texel
  const gpu::LentImage* image = nullptr;  // or a picture on the window's device, good until the next is taken
  uint32_t channels = 4;                  // of the floats that mean something
  std::string name, note;
};

// A pixel taken apart by the technique.
struct Inspected {
  std::string technique;
  uint64_t frame = 0;
  glm::uvec2 size{0};    // of the picture
  float vfov = 1;        // of its camera
  bool possible = true;  // false: the technique tells nothing of its samples
  passes::Inspection data;
};

// One frame. Members are moved out by whoever takes it.
struct Published {
  uint64_t number = 0;    // frames since the start
  uint64_t revision = 0;  // of the Wanted it shows
  uint32_t settled = 0;   // frames since that revision
  bool moving = false, reduced = false;
  MadeWith made_with;
  Pixels picture;
  std::vector<PassRow> passes;
  float frame_ms = 0, wall_ms = 0, record_ms = 0;
  int64_t submit_ns = 0;           // on CLOCK_MONOTONIC
  double time = 0;                 // the scene's
  std::optional<GraphInfo> graph;  // when it is another than the last frame's
  std::optional<Picked> picked;
  std::optional<ProbeWanted> probe_of;
  std::optional<Pixels> probe;
  std::string probe_error;
  std::vector<image::Layer> layers;     // those that were wanted and are there
  std::vector<std::string> not_finite;  // debug.nan_scan: images with NaN or infinite texels, and where
  std::optional<Inspected> inspected;
  uint32_t draws = 0;
  uint64_t host_bytes = 0;  // that were copied to the host
};

enum class EventKind : uint8_t {
  DeviceOpened,  // text: its name
  SceneLoading,  // text: path
  SceneLoaded,
  EnvironmentLoaded,
  SceneCopied,
  Failed,         // text: a sentence; the last picture stays
  ShaderBroken,   // faults
  ShadersLoaded,  // text, ms
  Mended,         // what had failed works again
  Saved,          // text: path
  DeviceLost      // text; nothing is rendered until Restart
};
struct Event {
  EventKind kind;
  std::string text;
  nlohmann::json context;  // DeviceOpened: what timing files say about the device
  double ms = 0;
  std::vector<gpu::ReloadError> faults;
  SceneInfo scene;
  MadeWith made_with;                  // Saved
  std::unique_ptr<scene::Scene> copy;  // SceneCopied: as it stands now
  bool software = false;
};

}  // namespace nf::editor::live
