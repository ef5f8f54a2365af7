// Draws Dear ImGui's triangles as passes of a graph of its own. Pictures shown in the window are tables of texels in
// host memory, or, one of them, an image on this device that the scene's renderer has filled.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
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
  Flip,
  Texture,
  Preview,
  SplitTotal,
  SplitEstimator,
  SplitMissing,
  Count
};

enum Channel : uint8_t { Red = 1, Green = 2, Blue = 4, Alpha = 8, Rgb = 7 };
// The colours of a single number; all but grey show the first channel that is on, however many are.
enum class Map : uint8_t { Grey, Viridis, Diverging, FalseColor };

// How a picture is shown. Bytes are shown as they are; floats by channels, range and colours.
struct PictureLook {
  uint8_t channels = Rgb;
  Map map = Map::Grey;
  float low = 0, high = 1;
  bool nearest = false, srgb = false, mark_outside = false, logarithmic = false;
  uint8_t chosen_for = 0;  // how many channels the picture had that `channels` was chosen for
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
  // Of the floats the first `channels` mean something.
  void set_picture(PictureId id, glm::uvec2 size, std::span<const float> rgba, uint32_t channels = 4);
  // An RGBA8 image, which has to stay as it is until the picture is set again. One picture at a time may be one.
  void set_picture(PictureId id, const gpu::LentImage& image);
  // All that `other` keeps in host memory: for a renderer that takes its place on another device.
  void adopt(Renderer& other);
  // A picture, of whatever kind, kept as another. False when there is none.
  bool copy(PictureId from, PictureId to);
  // RGBA8 texels, from wherever they are; an image's are waited for. Empty when there is none, or it is of floats.
  std::vector<uint8_t> texels(PictureId id);
  // One of them, to be asked for in every frame: an image's comes with the next.
  std::optional<glm::u8vec4> texel(PictureId id, glm::uvec2 at);
  std::vector<float> floats(PictureId id) const;
  glm::uvec2 size_of(PictureId id) const { return pictures_[size_t(id)].size; }
  bool has_floats(PictureId id) const { return pictures_[size_t(id)].floats; }
  uint32_t channels_of(PictureId id) const { return pictures_[size_t(id)].channels; }
  // Another number for each picture that was ever set; 0: none was.
  uint64_t version_of(PictureId id) const { return pictures_[size_t(id)].version; }

  // For ImGui::Image(), good until the end of this frame.
  void* show(PictureId id, const PictureLook& look = {});
  // |a - b| in false colours, `high` being the lightest; relative: over |b|, which counts as 0.01 at least. Of pictures
  // of the same kind.
  void* show_difference(PictureId a, PictureId b, float high, bool relative, bool nearest);
  // Of each pixel the greatest of its colours' differences; empty when the two are not of one kind and size.
  std::vector<float> difference(PictureId a, PictureId b, bool relative);

  // Renders and waits: RGBA8 texels of `size`, good until the next call.
  std::span<const std::byte> draw(const ImDrawData& data, glm::uvec2 size);
  // Its programs anew, those of them that depend on these files; empty: all.
  gpu::Reload reload(const std::vector<std::string>& changed) { return pipelines_->reload(changed); }
  double last_ms() const { return last_ms_; }
  gpu::Device& device() { return device_; }

 private:
  struct Picture {
    glm::uvec2 size{0};
    bool floats = false;
    uint32_t channels = 4;
    uint64_t version = 0;
    std::vector<uint32_t> words;
    const gpu::LentImage* image = nullptr;  // instead of words
    uint32_t first = 0;                     // in the buffer
    bool changed = false;
  };
  // A row as shaders/ui.frag declares it (scalar layout).
  struct DrawRow {
    uint32_t kind = 0, first = 0, second = 0;
    glm::uvec2 size{0}, second_size{0};
    uint32_t show = 0, flags = 0;  // of floats: channels, from bit 4 on the map
    float low = 0, high = 1;
  };
  struct Command {
    uint32_t first_index, count, kind;
    glm::ivec4 clip;  // x, y, width, height
  };
  void set_words(PictureId id, glm::uvec2 size, bool floats, const void* data);
  void fill_texels();
  // Rows [first, end) of commands_: those of a kind, or all.
  struct Run {
    uint32_t kind, first, end;
  };
  static constexpr uint32_t every_kind = ~0u;
  std::vector<Run> picture_runs() const;
  void draw_run(const graph::Recorder& recorder, const Run& run) const;
  void reserve(gpu::Buffer& buffer, uint64_t bytes, VkBufferUsageFlags usage, const char* name);

  gpu::Device& device_;
  std::unique_ptr<gpu::Pipelines> pipelines_;
  std::unique_ptr<graph::Executor> executor_;
  gpu::Pipeline pipeline_;
  gpu::Pipeline pixel_pipeline_;
  std::array<gpu::Pipeline, 6> picture_pipelines_;  // by kind; 0 is text, which has none
  gpu::Image font_;
  gpu::Buffer vertices_, indices_, draws_, texels_;
  std::array<Picture, size_t(PictureId::Count)> pictures_;
  uint64_t versions_ = 0;
  std::vector<DrawRow> shown_;  // row 0 is text
  std::vector<Command> commands_;
  std::vector<graph::Readback> readbacks_;
  std::optional<glm::uvec2> texel_asked_;  // of the image, in this frame
  std::optional<glm::u8vec4> texel_seen_;
  double last_ms_ = 0;
};

}  // namespace nf::editor::ui
