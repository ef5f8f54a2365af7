// Raster passes over vertices that are pulled from a table: pictures first, each in its place, then everything.
#include "ui/renderer.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <imgui.h>
#include <utility>

#include "gpu/shader.h"
#include "gpu/upload.h"

namespace nf::editor::ui {
namespace {

#define NF_UI_FIELDS(F) F(Vec2, pixel_to_clip)
NF_DECLARE_BLOCK(UiBlock, "ui", NF_UI_FIELDS)
#define NF_UI_PIXEL_FIELDS(F) F(IVec2, place)
NF_DECLARE_BLOCK(UiPixelBlock, "ui_pixel", NF_UI_PIXEL_FIELDS)

struct Vertex {
  glm::vec2 position, uv;
  uint32_t color, draw;
};

// The last two are of a picture that is an image, which the last compares with bytes.
enum Kind : uint32_t { Text, Bytes, Floats, Difference, Image, ImageDifference, KindCount };
constexpr bool has_image(uint32_t kind) {
  return kind >= Image;
}
constexpr bool has_table(uint32_t kind) {
  return kind != Image;
}
enum Flag : uint32_t { Nearest = 1, Srgb = 2, MarkOutside = 4, Relative = 8, Logarithmic = 16 };
constexpr float least_reference = 0.01f;  // as ui_picture.frag

}  // namespace

Renderer::Renderer(gpu::Device& device) : device_(device) {
  const std::filesystem::path cache = gpu::cache_folder();
  gpu::ShaderCompiler compiler(gpu::find_shader_folder(), cache, gpu::shipped_spirv());
  compiler.add_table(UiBlock::table());
  compiler.add_table(UiPixelBlock::table());
  pipelines_ = std::make_unique<gpu::Pipelines>(device, std::move(compiler), cache);
  pipeline_ = pipelines_->raster("ui.vert", "ui.frag", {}, {.over = true});
  for (uint32_t kind = Bytes; kind < KindCount; ++kind)
    picture_pipelines_[kind] = pipelines_->raster("ui.vert", "ui_picture.frag",
                                                  {{"KIND", kind == Image             ? "1"
                                                            : kind == ImageDifference ? "3"
                                                                                      : fmt::format("{}", kind)},
                                                   {"IMAGE", has_image(kind) ? "1" : "0"}},
                                                  {});
  pixel_pipeline_ = pipelines_->compute("ui_pixel.comp");
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
  picture.channels = 4;
  picture.version = ++versions_;
  picture.image = nullptr;
  picture.words.resize(size_t(size.x) * size.y * (floats ? 4 : 1));
  std::memcpy(picture.words.data(), data, picture.words.size() * 4);
  picture.changed = true;
}
void Renderer::set_picture(PictureId id, glm::uvec2 size, std::span<const uint8_t> rgba) {
  NF_CHECK(rgba.size() == size_t(size.x) * size.y * 4, "{} bytes for {}x{}", rgba.size(), size.x, size.y);
  set_words(id, size, false, rgba.data());
}
void Renderer::set_picture(PictureId id, glm::uvec2 size, std::span<const float> rgba, uint32_t channels) {
  NF_CHECK(rgba.size() == size_t(size.x) * size.y * 4, "{} floats for {}x{}", rgba.size(), size.x, size.y);
  set_words(id, size, true, rgba.data());
  pictures_[size_t(id)].channels = channels;
}

void Renderer::set_picture(PictureId id, const gpu::LentImage& image) {
  pictures_[size_t(id)] = {
      .size = {image.image.info.extent.width, image.image.info.extent.height}, .version = ++versions_, .image = &image};
}

void Renderer::adopt(Renderer& other) {
  pictures_ = std::move(other.pictures_);
  versions_ = other.versions_;
  for (Picture& picture : pictures_) {
    if (picture.image) picture = {};
    picture.changed = true;
  }
}

bool Renderer::copy(PictureId from, PictureId to) {
  const Picture& picture = pictures_[size_t(from)];
  if (!picture.image && picture.words.empty()) return false;
  if (picture.image) {
    set_picture(to, picture.size, std::span<const uint8_t>(texels(from)));
  } else {
    pictures_[size_t(to)] = picture;
    pictures_[size_t(to)].version = ++versions_;
    pictures_[size_t(to)].changed = true;
  }
  return true;
}

std::vector<uint8_t> Renderer::texels(PictureId id) {
  const Picture& picture = pictures_[size_t(id)];
  std::vector<uint8_t> out;
  if (picture.image) {
    const std::vector<std::byte> bytes = gpu::download_image(device_, *picture.image);
    out.resize(bytes.size());
    std::memcpy(out.data(), bytes.data(), bytes.size());
  } else if (!picture.floats && !picture.words.empty()) {
    out.resize(picture.words.size() * 4);
    std::memcpy(out.data(), picture.words.data(), out.size());
  }
  return out;
}

std::vector<float> Renderer::floats(PictureId id) const {
  const Picture& picture = pictures_[size_t(id)];
  std::vector<float> out;
  if (!picture.floats) return out;
  out.resize(picture.words.size());
  std::memcpy(out.data(), picture.words.data(), out.size() * 4);
  return out;
}

std::optional<glm::u8vec4> Renderer::texel(PictureId id, glm::uvec2 at) {
  const Picture& picture = pictures_[size_t(id)];
  if (picture.floats || at.x >= picture.size.x || at.y >= picture.size.y) return std::nullopt;
  if (picture.image) {
    texel_asked_ = at;
    return texel_seen_;
  }
  glm::u8vec4 texel;
  std::memcpy(&texel, &picture.words[size_t(at.y) * picture.size.x + at.x], 4);
  return texel;
}

void* Renderer::show(PictureId id, const PictureLook& look) {
  const Picture& picture = pictures_[size_t(id)];
  if (picture.words.empty() && !picture.image) return nullptr;
  shown_.push_back({.kind = picture.image    ? Image
                            : picture.floats ? Floats
                                             : Bytes,
                    .first = uint32_t(id),
                    .size = picture.size,
                    .show = uint32_t(look.channels) | uint32_t(look.map) << 4,
                    .flags = (look.nearest ? Nearest : 0u) | (look.srgb ? Srgb : 0u) |
                             (look.mark_outside ? MarkOutside : 0u) | (look.logarithmic ? Logarithmic : 0u),
                    .low = look.low,
                    .high = look.high});
  return reinterpret_cast<void*>(shown_.size() - 1);
}

void* Renderer::show_difference(PictureId a, PictureId b, float high, bool relative, bool nearest) {
  const Picture &one = pictures_[size_t(a)], &two = pictures_[size_t(b)];
  if ((one.words.empty() && !one.image) || two.words.empty() || one.floats != two.floats) return nullptr;
  shown_.push_back({.kind = one.image ? ImageDifference : Difference,
                    .first = uint32_t(a),
                    .second = uint32_t(b),
                    .size = one.size,
                    .second_size = two.size,
                    .show = one.floats ? 1u : 0u,
                    .flags = (nearest ? Nearest : 0u) | (relative ? Relative : 0u),
                    .low = 0,
                    .high = high});
  return reinterpret_cast<void*>(shown_.size() - 1);
}

std::vector<float> Renderer::difference(PictureId a, PictureId b, bool relative) {
  const Picture &one = pictures_[size_t(a)], &two = pictures_[size_t(b)];
  std::vector<float> out;
  if (one.size != two.size || one.floats != two.floats || two.words.empty()) return out;
  const std::vector<uint8_t> lent = one.image ? texels(a) : std::vector<uint8_t>();
  const auto value = [](const void* texels, bool floats, size_t at) {
    float x = 0;
    if (floats)
      std::memcpy(&x, static_cast<const float*>(texels) + at, 4);
    else
      x = float(static_cast<const uint8_t*>(texels)[at]) / 255.0f;
    return x;
  };
  const void* first = one.image ? static_cast<const void*>(lent.data()) : one.words.data();
  for (size_t i = 0; i < size_t(one.size.x) * one.size.y; ++i) {
    float& most = out.emplace_back(0.0f);
    for (size_t c = 0; c < 3; ++c) {
      const float x = value(first, one.floats, i * 4 + c), y = value(two.words.data(), two.floats, i * 4 + c);
      most = std::max(most, std::abs(x - y) / (relative ? std::max(std::abs(y), least_reference) : 1.0f));
    }
  }
  return out;
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
    if (shown_[i].kind == Difference || shown_[i].kind == ImageDifference)
      shown_[i].second = pictures_[shown_[i].second].first;
  }
}

// Pictures lie over one another in the order of their commands; a pass draws those of one kind that follow each other.
std::vector<Renderer::Run> Renderer::picture_runs() const {
  std::vector<Run> runs;
  for (uint32_t i = 0; i < commands_.size(); ++i) {
    const uint32_t kind = commands_[i].kind;
    if (kind == Text) continue;
    if (runs.empty() || runs.back().kind != kind) runs.push_back({kind, i, i});
    runs.back().end = i + 1;
  }
  if (runs.empty()) runs.push_back({Bytes, 0, 0});  // clears all the same
  return runs;
}

void Renderer::draw_run(const graph::Recorder& recorder, const Run& run) const {
  recorder.set_cull(VK_CULL_MODE_NONE, VK_FRONT_FACE_COUNTER_CLOCKWISE);
  recorder.bind_indices(indices_.handle);
  for (const Command& c : std::span(commands_).subspan(run.first, run.end - run.first)) {
    if (run.kind != every_kind && c.kind != run.kind) continue;
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
  const auto lent = std::find_if(pictures_.begin(), pictures_.end(), [](const Picture& p) { return p.image; });
  const gpu::LentImage* image = lent == pictures_.end() ? nullptr : lent->image;
  static constexpr const char* names[] = {"",         "ui.bytes",           "ui.floats", "ui.difference",
                                          "ui.image", "ui.image_difference"};
  bool clear = true;
  for (const Run& run : picture_runs()) {
    const uint32_t kind = run.kind;
    auto pass = graph.raster(names[kind], picture_pipelines_[kind], "Pictures, each in its place");
    pass.in("vertices", vertices).in("draws", graph.import("ui.draws", draws_));
    if (has_table(kind)) pass.in("texels", graph.import("ui.texels", texels_));
    if (has_image(kind)) pass.in("shown", graph.import("ui.shown", image->image));
    pass.draw([this, run](const graph::Recorder& recorder) { draw_run(recorder, run); });
    if (std::exchange(clear, false))
      pass.out("pictures", pictures, {0, 0, 0, 1});
    else
      pass.out("pictures", pictures);
  }
  graph.raster("ui.draw", pipeline_, "The user interface")
      .in("vertices", vertices)
      .in("pictures", pictures)
      .in("font", graph.import("ui.font", font_))
      .out("picture", picture, {0.08f, 0.08f, 0.09f, 1})
      .draw([this, all = Run{every_kind, 0, uint32_t(commands_.size())}](const graph::Recorder& recorder) {
        draw_run(recorder, all);
      });
  graph.readback("readback.ui", picture);
  const std::optional<glm::uvec2> place = image ? std::exchange(texel_asked_, std::nullopt) : std::nullopt;
  if (place) {
    const graph::Buf found = graph.buffer("ui.texel", 16);
    graph.compute("ui.pixel", pixel_pipeline_, "The texel under the pointer")
        .in("shown", graph.import("ui.shown", image->image))
        .out("texels", found)
        .params(UiPixelBlock{.place = glm::min(*place, lent->size - 1u)})
        .over(1);
    graph.readback("readback.texel", found);
  }
  executor_->run(graph, {.after = image ? image->written : gpu::TimelinePoint{}});
  const graph::FrameResult result = executor_->finish();
  last_ms_ = 0;
  for (const graph::PassTime& pass : result.passes)
    if (pass.kind != graph::PassKind::Readback) last_ms_ += pass.ms;
  readbacks_ = executor_->take_readbacks();
  texel_seen_.reset();
  if (place) std::memcpy(&texel_seen_.emplace(), readbacks_.at(1).texels.data(), 4);
  shown_.resize(1);
  return readbacks_.at(0).texels;
}

}  // namespace nf::editor::ui
