// Raster passes over vertices that are pulled from a table: pictures first, each in its place, then everything.
#include "ui/renderer.h"

#include <algorithm>
#include <cstring>
#include <imgui.h>

#include "gpu/shader.h"
#include "gpu/upload.h"

namespace nf::editor::ui {
namespace {

#define NF_UI_FIELDS(F) F(Vec2, pixel_to_clip)
NF_DECLARE_BLOCK(UiBlock, "ui", NF_UI_FIELDS)

struct Vertex {
  glm::vec2 position, uv;
  uint32_t color, draw;
};

enum Kind : uint32_t { Text, Bytes, Floats, Difference };
enum Flag : uint32_t { Nearest = 1, Srgb = 2, MarkOutside = 4 };

}  // namespace

Renderer::Renderer(gpu::Device& device) : device_(device) {
  const std::filesystem::path cache = gpu::cache_folder();
  gpu::ShaderCompiler compiler(gpu::find_shader_folder(), cache);
  compiler.add_table(UiBlock::table());
  pipelines_ = std::make_unique<gpu::Pipelines>(device, std::move(compiler), cache);
  pipeline_ = pipelines_->raster("ui.vert", "ui.frag", {}, {.over = true});
  for (uint32_t kind = Bytes; kind <= Difference; ++kind)
    picture_pipelines_[kind] =
        pipelines_->raster("ui.vert", "ui_picture.frag", {{"KIND", fmt::format("{}", kind)}}, {});
  executor_ = std::make_unique<graph::Executor>(device, *pipelines_);
  shown_.emplace_back();
  reserve(texels_, 16, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, "ui.texels");
}

Renderer::~Renderer() {
  executor_.reset();
  for (gpu::Buffer* buffer : {&vertices_, &indices_, &draws_, &texels_}) gpu::destroy(device_, *buffer);
  gpu::destroy(device_, font_);
}

// Every frame is waited for, so nothing here is in use.
void Renderer::reserve(gpu::Buffer& buffer, uint64_t bytes, VkBufferUsageFlags usage, const char* name) {
  if (buffer.size >= bytes) return;
  gpu::destroy(device_, buffer);
  buffer = gpu::create_buffer(device_, std::max<uint64_t>(bytes * 3 / 2, 4096), usage, gpu::Where::Host, name);
}

void Renderer::set_font(ImFontAtlas& atlas) {
  unsigned char* alpha = nullptr;
  int width = 0, height = 0;
  atlas.GetTexDataAsAlpha8(&alpha, &width, &height);
  gpu::destroy(device_, font_);
  const gpu::ImagePart part{.texels = std::as_bytes(std::span(alpha, size_t(width) * size_t(height)))};
  font_ = gpu::upload_image(device_, {.extent = {uint32_t(width), uint32_t(height)}, .format = VK_FORMAT_R8_UNORM},
                            {&part, 1}, "ui.font", gpu::WholeView::Flat);
  atlas.SetTexID(nullptr);
}

void Renderer::set_words(PictureId id, glm::uvec2 size, bool floats, const void* data) {
  Picture& picture = pictures_[size_t(id)];
  picture.size = size;
  picture.floats = floats;
  picture.words.resize(size_t(size.x) * size.y * (floats ? 4 : 1));
  std::memcpy(picture.words.data(), data, picture.words.size() * 4);
  picture.changed = true;
}
void Renderer::set_picture(PictureId id, glm::uvec2 size, std::span<const uint8_t> rgba) {
  NF_CHECK(rgba.size() == size_t(size.x) * size.y * 4, "{} bytes for {}x{}", rgba.size(), size.x, size.y);
  set_words(id, size, false, rgba.data());
}
void Renderer::set_picture(PictureId id, glm::uvec2 size, std::span<const float> rgba) {
  NF_CHECK(rgba.size() == size_t(size.x) * size.y * 4, "{} floats for {}x{}", rgba.size(), size.x, size.y);
  set_words(id, size, true, rgba.data());
}

void* Renderer::show(PictureId id, const PictureLook& look) {
  const Picture& picture = pictures_[size_t(id)];
  if (picture.words.empty()) return nullptr;
  shown_.push_back(
      {.kind = picture.floats ? Floats : Bytes,
       .first = uint32_t(id),
       .size = picture.size,
       .show = uint32_t(look.show),
       .flags = (look.nearest ? Nearest : 0u) | (look.srgb ? Srgb : 0u) | (look.mark_outside ? MarkOutside : 0u),
       .low = look.low,
       .high = look.high});
  return reinterpret_cast<void*>(shown_.size() - 1);
}

void* Renderer::show_difference(PictureId a, PictureId b, float low, float high, bool nearest) {
  const Picture &one = pictures_[size_t(a)], &two = pictures_[size_t(b)];
  if (one.words.empty() || two.words.empty() || one.floats != two.floats) return nullptr;
  shown_.push_back({.kind = Difference,
                    .first = uint32_t(a),
                    .second = uint32_t(b),
                    .size = one.size,
                    .second_size = two.size,
                    .show = one.floats ? 1u : 0u,
                    .flags = nearest ? Nearest : 0u,
                    .low = low,
                    .high = high});
  return reinterpret_cast<void*>(shown_.size() - 1);
}

// All pictures stand one after the other. `first` and `second` of the rows become places in the buffer.
void Renderer::fill_texels() {
  uint32_t at = 0;
  bool moved = false;
  for (Picture& picture : pictures_) {
    moved |= picture.first != at;
    picture.first = at;
    at += uint32_t(picture.words.size());
  }
  const VkBuffer before = texels_.handle;
  reserve(texels_, uint64_t(at) * 4, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, "ui.texels");
  moved |= texels_.handle != before;
  for (Picture& picture : pictures_) {
    if (picture.words.empty() || (!moved && !picture.changed)) continue;
    std::memcpy(texels_.mapped + size_t(picture.first) * 4, picture.words.data(), picture.words.size() * 4);
    picture.changed = false;
  }
  for (size_t i = 1; i < shown_.size(); ++i) {
    shown_[i].first = pictures_[shown_[i].first].first;
    if (shown_[i].kind == Difference) shown_[i].second = pictures_[shown_[i].second].first;
  }
}

void Renderer::draw_commands(const graph::Recorder& recorder, uint32_t kind) const {
  recorder.set_cull(VK_CULL_MODE_NONE, VK_FRONT_FACE_COUNTER_CLOCKWISE);
  recorder.bind_indices(indices_.handle);
  for (const Command& c : commands_) {
    if (kind != every_kind && c.kind != kind) continue;
    recorder.set_scissor(c.clip.x, c.clip.y, uint32_t(c.clip.z), uint32_t(c.clip.w));
    recorder.draw_indexed(c.first_index, c.count);
  }
}

std::span<const std::byte> Renderer::draw(const ImDrawData& data, glm::uvec2 size) {
  fill_texels();
  const auto storage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
  reserve(vertices_, size_t(data.TotalVtxCount) * sizeof(Vertex), storage, "ui.vertices");
  reserve(indices_, size_t(data.TotalIdxCount) * 4, VK_BUFFER_USAGE_INDEX_BUFFER_BIT, "ui.indices");
  reserve(draws_, shown_.size() * sizeof(DrawRow), storage, "ui.draws");
  std::memcpy(draws_.mapped, shown_.data(), shown_.size() * sizeof(DrawRow));

  auto* vertex = reinterpret_cast<Vertex*>(vertices_.mapped);
  auto* index = reinterpret_cast<uint32_t*>(indices_.mapped);
  uint32_t first_vertex = 0, first_index = 0;
  commands_.clear();
  for (int l = 0; l < data.CmdListsCount; ++l) {
    const ImDrawList& list = *data.CmdLists[l];
    for (int v = 0; v < list.VtxBuffer.Size; ++v) {
      const ImDrawVert& from = list.VtxBuffer[v];
      vertex[first_vertex + uint32_t(v)] = {{from.pos.x, from.pos.y}, {from.uv.x, from.uv.y}, from.col, 0};
    }
    for (const ImDrawCmd& command : list.CmdBuffer) {
      if (command.UserCallback || command.ElemCount == 0) continue;
      const uint32_t row = uint32_t(reinterpret_cast<uintptr_t>(command.GetTexID()));
      const uint32_t base = first_vertex + command.VtxOffset;
      for (uint32_t i = 0; i < command.ElemCount; ++i) {
        const uint32_t v = base + list.IdxBuffer[int(command.IdxOffset + i)];
        index[first_index + i] = v;
        vertex[v].draw = row;
      }
      const glm::vec2 limit(size);
      const glm::ivec2 low = glm::clamp(glm::vec2(command.ClipRect.x, command.ClipRect.y), glm::vec2(0), limit);
      const glm::ivec2 high = glm::clamp(glm::vec2(command.ClipRect.z, command.ClipRect.w), glm::vec2(0), limit);
      if (high.x > low.x && high.y > low.y)
        commands_.push_back({first_index, command.ElemCount, shown_[row].kind, {low, high - low}});
      first_index += command.ElemCount;
    }
    first_vertex += uint32_t(list.VtxBuffer.Size);
  }

  graph::Graph graph;
  graph.share(UiBlock{.pixel_to_clip = 2.0f / glm::vec2(size)});
  const graph::Buf vertices = graph.import("ui.vertices", vertices_);
  const graph::Tex pictures = graph.image("ui.pictures", {{size.x, size.y}, VK_FORMAT_R8G8B8A8_UNORM});
  const graph::Tex picture = graph.image("ui.picture", {{size.x, size.y}, VK_FORMAT_R8G8B8A8_UNORM});
  static constexpr const char* names[] = {"", "ui.bytes", "ui.floats", "ui.difference"};
  for (uint32_t kind = Bytes; kind <= Difference; ++kind) {
    const bool any = std::any_of(commands_.begin(), commands_.end(), [&](const Command& c) { return c.kind == kind; });
    if (!any && kind != Bytes) continue;  // the first clears
    auto pass = graph.raster(names[kind], picture_pipelines_[kind], "Pictures, each in its place");
    pass.in("vertices", vertices)
        .in("draws", graph.import("ui.draws", draws_))
        .in("texels", graph.import("ui.texels", texels_))
        .draw([this, kind](const graph::Recorder& recorder) { draw_commands(recorder, kind); });
    if (kind == Bytes)
      pass.out("pictures", pictures, {0, 0, 0, 1});
    else
      pass.out("pictures", pictures);
  }
  graph.raster("ui.draw", pipeline_, "The user interface")
      .in("vertices", vertices)
      .in("pictures", pictures)
      .in("font", graph.import("ui.font", font_))
      .out("picture", picture, {0.08f, 0.08f, 0.09f, 1})
      .draw([this](const graph::Recorder& recorder) { draw_commands(recorder, every_kind); });
  graph.readback("readback.ui", picture);
  executor_->run(graph);
  const graph::FrameResult result = executor_->finish();
  last_ms_ = 0;
  for (const graph::PassTime& pass : result.passes)
    if (pass.kind != graph::PassKind::Readback) last_ms_ += pass.ms;
  readbacks_ = executor_->take_readbacks();
  shown_.resize(1);
  return readbacks_.at(0).texels;
}

}  // namespace nf::editor::ui
