// Draws Dear ImGui's triangles as passes of a graph of its own. Pictures shown in the window are tables of texels in
// host memory: the scene is rendered on another device, and its results come as bytes.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <vector>

#include "gpu/device.h"
#include "graph/executor.h"

struct ImDrawData;
struct ImFontAtlas;

namespace nf::editor::ui {

// The pictures there are. Each keeps its texels until it is set again.
enum class PictureId : uint8_t {
  Scene,
  Reference,
  SlotA,
  Texture,
  Preview,
  SplitTotal,
  SplitEstimator,
  SplitMissing,
  Count
};

enum class Show : uint32_t { Rgb, Red, Green, Blue, Alpha, FalseColor };

// How a picture is shown. Bytes are shown as they are; floats by range, channel and false colours.
struct PictureLook {
  Show show = Show::Rgb;
  float low = 0, high = 1;
  bool nearest = false, srgb = false, mark_outside = false;
};

class Renderer {
 public:
  explicit Renderer(gpu::Device& device);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  // After the atlas was built, and each time it was built anew.
  void set_font(ImFontAtlas& atlas);
  // RGBA8 texels or four floats a texel, rows tightly packed.
  void set_picture(PictureId id, glm::uvec2 size, std::span<const uint8_t> rgba);
  void set_picture(PictureId id, glm::uvec2 size, std::span<const float> rgba);
  glm::uvec2 size_of(PictureId id) const { return pictures_[size_t(id)].size; }

  // For ImGui::Image(), good until the end of this frame.
  void* show(PictureId id, const PictureLook& look = {});
  // |a - b| in false colours, `high` being the lightest. Of pictures of the same kind.
  void* show_difference(PictureId a, PictureId b, float low, float high, bool nearest);

  // Renders and waits: RGBA8 texels of `size`, good until the next call.
  std::span<const std::byte> draw(const ImDrawData& data, glm::uvec2 size);
  double last_ms() const { return last_ms_; }
  gpu::Device& device() { return device_; }

 private:
  struct Picture {
    glm::uvec2 size{0};
    bool floats = false;
    std::vector<uint32_t> words;
    uint32_t first = 0;  // in the buffer
    bool changed = false;
  };
  // A row as shaders/ui.frag declares it (scalar layout).
  struct DrawRow {
    uint32_t kind = 0, first = 0, second = 0;
    glm::uvec2 size{0}, second_size{0};
    uint32_t show = 0, flags = 0;
    float low = 0, high = 1;
  };
  struct Command {
    uint32_t first_index, count, kind;
    glm::ivec4 clip;  // x, y, width, height
  };
  void set_words(PictureId id, glm::uvec2 size, bool floats, const void* data);
  void fill_texels();
  static constexpr uint32_t every_kind = ~0u;
  void draw_commands(const graph::Recorder& recorder, uint32_t kind) const;
  void reserve(gpu::Buffer& buffer, uint64_t bytes, VkBufferUsageFlags usage, const char* name);

  gpu::Device& device_;
  std::unique_ptr<gpu::Pipelines> pipelines_;
  std::unique_ptr<graph::Executor> executor_;
  gpu::Pipeline pipeline_;
  std::array<gpu::Pipeline, 4> picture_pipelines_;  // by kind; 0 is text, which has none
  gpu::Image font_;
  gpu::Buffer vertices_, indices_, draws_, texels_;
  std::array<Picture, size_t(PictureId::Count)> pictures_;
  std::vector<DrawRow> shown_;  // row 0 is text
  std::vector<Command> commands_;
  std::vector<graph::Readback> readbacks_;
  double last_ms_ = 0;
};

}  // namespace nf::editor::ui
