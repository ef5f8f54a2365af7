// The frame graph as a value: rows for resources, passes and uses. Building one makes no Vulkan call; compile()
// (plan.h) turns it into a Plan, execute() (executor.h) runs that. Declared order is execution order.
//
//   Tex visibility = graph.image("gtao.visibility", {size, VK_FORMAT_R16_SFLOAT});
//   graph.compute("gtao.trace", trace_pipeline, "Horizon search along slices")
//       .in("depth", gbuffer.depth).in("normal", gbuffer.normal).out("visibility",
//       visibility).params(settings).over(visibility);
//
// Mips and layers are used one by one with mip() and layer(): graph.compute(...).in("above", mip(pyramid, 0)) ...
// Names are string literals (or live as long as the graph): they are kept as pointers.
#pragma once

#include <cstring>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "core/params.h"
#include "gpu/memory.h"
#include "gpu/pipeline.h"
#include "graph/access.h"

namespace nf::graph {

// A resource of one graph, by row. `graph` tells handles of another graph apart: a frame builds a new one.
template <class Tag>
struct ResourceHandle {
  uint16_t id = 0xffff, graph = 0;
  constexpr bool valid() const { return id != 0xffff; }
  constexpr explicit operator bool() const { return valid(); }
  constexpr bool operator==(const ResourceHandle&) const = default;
};
using Tex = ResourceHandle<struct TexTag>;
using Buf = ResourceHandle<struct BufTag>;

// Mips [mip, mip + mips) of layers [layer, layer + layers); `all` is whatever there is from there on.
struct Part {
  static constexpr uint8_t all = 0xff;
  uint8_t mip = 0, mips = all, layer = 0, layers = all;
  constexpr bool operator==(const Part&) const = default;
};
constexpr bool overlap(const Part& a, const Part& b) {
  return a.mip < b.mip + b.mips && b.mip < a.mip + a.mips && a.layer < b.layer + b.layers &&
         b.layer < a.layer + a.layers;
}

// What a pass uses of an image: all of it, or a part.
struct TexPart {
  Tex tex;
  Part part;
  constexpr TexPart(Tex whole) : tex(whole) {}
  constexpr TexPart(Tex of, Part which) : tex(of), part(which) {}
};
constexpr TexPart mip(TexPart of, uint8_t mip) {
  return {of.tex, {mip, 1, of.part.layer, of.part.layers}};
}
constexpr TexPart mips(TexPart of, uint8_t first, uint8_t count) {
  return {of.tex, {first, count, of.part.layer, of.part.layers}};
}
constexpr TexPart layer(TexPart of, uint8_t layer) {
  return {of.tex, {of.part.mip, of.part.mips, layer, 1}};
}

// Where a call was written. std::source_location is missing from Clang 14 with Debian 12's standard library.
struct Location {
  const char* file = "";
  uint32_t line = 0;
  static constexpr Location current(const char* file = __builtin_FILE(), uint32_t line = __builtin_LINE()) {
    return {file, line};
  }
};

struct Size {
  uint32_t width = 1, height = 1;
  bool operator==(const Size&) const = default;
};

struct Texel {
  uint32_t x = 0, y = 0;
  bool operator==(const Texel&) const = default;
};

struct ImageDesc {
  Size size;
  VkFormat format = VK_FORMAT_UNDEFINED;
  uint8_t mips = 1, layers = 1;
  bool operator==(const ImageDesc&) const = default;
};

// prev is what the last frame wrote to next. valid is false when there is no such frame: prev then reads as zeros.
// A shader that reads prev through the slot "x" has a parameter "x_valid": the graph fills it in.
struct History {
  Tex prev, next;
  bool valid = false;
};
struct BufferHistory {
  Buf prev, next;
  bool valid = false;
};

// What the executor remembers between frames: which histories were written by the last frame, and what kept images
// hold.
struct HistoryState {
  std::string name;
  ImageDesc desc;                    // images
  uint64_t bytes;                    // buffers; 0 for images
  std::vector<uint64_t> marks = {};  // of a kept image, by layer
};

struct Clear {
  bool clear = false;
  float color[4] = {0, 0, 0, 0};
};

// Imported: a buffer (scene tables) or an image (environment maps) that lives outside the frame and is only read in it.
// Kept: one image whose content goes from frame to frame, and of which a frame writes what it likes.
enum class Lifetime : uint8_t { Transient, HistoryPrev, HistoryNext, Imported, Kept };

inline constexpr uint16_t no_resource = 0xffff;

struct ResourceRow {
  const char* name;
  bool is_buffer = false;
  Lifetime lifetime = Lifetime::Transient;
  bool optional = false;  // may stay unread
  bool valid = false;     // HistoryPrev: the last frame wrote it; Kept: the last frame had it
  ImageDesc desc;         // images
  uint64_t bytes = 0;     // buffers
  const gpu::Buffer* imported = nullptr;
  const gpu::Image* imported_image = nullptr;
  uint16_t pair = no_resource;  // HistoryPrev <-> HistoryNext
  uint32_t first_mark = 0;      // Kept: row of Graph::marks, one a layer
  Location at;
};
// Mips x layers of an image, 1 of a buffer: what has a state of its own. Cell = layer * mips + mip.
inline uint32_t cell_count(const ResourceRow& row) {
  return row.is_buffer ? 1 : uint32_t(row.desc.mips) * row.desc.layers;
}

struct UseRow {
  const char* slot;   // the shader's name for it; nullptr for depth, indices, arguments and copies
  uint16_t resource;  // no_resource: the handle was not of this graph
  Use use;
  Part part;  // counts are true ones; a buffer's is 0, 1, 0, 1
  Clear clear;
  Location at;
};

struct ParamRow {
  const ParamTable* table;
  uint32_t offset;  // into param_bytes
  Location at;
};

class Executor;

// Records draws of a raster pass. Has no barriers: those are the graph's.
struct Recorder {
  VkCommandBuffer commands;
  VkPipelineLayout layout;
  Executor* executor;
  VkExtent2D extent;  // of the attachments
  // A buffer of the graph that the pass has declared: indices, indirect arguments.
  VkBuffer buffer(Buf buffer) const;
  void bind_vertex_streams(std::span<const VkBuffer> buffers) const;
  void bind_indices(VkBuffer buffer) const;  // 32-bit
  void bind_set1(VkDescriptorSet set) const;
  void set_cull(VkCullModeFlags mode, VkFrontFace front) const;
  // Pixels of the attachments; all of them until this is called.
  void set_scissor(int32_t x, int32_t y, uint32_t width, uint32_t height) const;
  void draw_indexed(uint32_t first_index, uint32_t count) const;
  void draw_indexed_indirect(VkBuffer buffer, VkDeviceSize offset, uint32_t count) const;
  // All of the depth attachment: for a pass that only some frames draw anew.
  void clear_depth(float value) const;
};

// A trivially copyable callable of at most 64 bytes, so that a graph can be copied, hashed and replayed.
struct DrawCallback {
  void (*invoke)(const void*, const Recorder&) = nullptr;
  alignas(8) std::byte storage[64] = {};
  DrawCallback() = default;
  template <class F>
  explicit DrawCallback(const F& f) {
    static_assert(std::is_trivially_copyable_v<F> && sizeof(F) <= sizeof(storage),
                  "draw callbacks are small and trivially copyable");
    std::memcpy(storage, &f, sizeof(F));
    invoke = [](const void* data, const Recorder& recorder) { (*static_cast<const F*>(data))(recorder); };
  }
};

struct PassRow {
  const char* name;
  const char* description;
  PassKind kind;
  gpu::Pipeline pipeline;
  uint32_t first_use = 0, use_count = 0;
  uint32_t first_param = 0, param_count = 0;
  uint16_t over =
      no_resource;  // compute: the image whose texels (of over_part's first mip, layers in z) are the threads
  Part over_part;
  bool has_over = false;
  uint32_t threads = 0;                // compute: their number, where no image says it
  uint64_t argument_offset = 0;        // compute with indirect(): bytes
  const gpu::Image* target = nullptr;  // hand_over
  bool one_texel = false;              // read-back of an image: only this one; another place needs no other plan
  Texel texel;
  DrawCallback draw;
  Location at;
};

class Graph;

// Adds uses to the pass that was added last.
class PassBuilder {
 public:
  PassBuilder(Graph& graph, uint32_t pass) : graph_(graph), pass_(pass) {}
  PassBuilder& in(const char* slot, TexPart tex, Location at = Location::current());
  PassBuilder& in(const char* slot, Buf buffer, Location at = Location::current());
  // Compute: a storage image, all of which the pass writes. Full-screen and raster: the fragment output of this name.
  PassBuilder& out(const char* slot, TexPart tex, Location at = Location::current());
  PassBuilder& out(const char* slot, TexPart tex, std::array<float, 4> clear, Location at = Location::current());
  PassBuilder& out(const char* slot, Buf buffer, Location at = Location::current());
  PassBuilder& inout(const char* slot, TexPart tex, Location at = Location::current());
  PassBuilder& inout(const char* slot, Buf buffer, Location at = Location::current());
  PassBuilder& depth(TexPart tex, Location at = Location::current());
  PassBuilder& depth(TexPart tex, float clear, Location at = Location::current());
  // Compute: the number of workgroups, VkDispatchIndirectCommand at `offset` bytes. Raster: the arguments of the
  // callback's draws.
  PassBuilder& indirect(Buf buffer, uint64_t offset = 0, Location at = Location::current());
  // Raster: the callback's index buffer.
  PassBuilder& indices(Buf buffer, Location at = Location::current());
  template <class P>
  PassBuilder& params(const P& block, Location at = Location::current()) {
    return params_raw(P::table(), &block, at);
  }
  PassBuilder& params_raw(const ParamTable& table, const void* data, Location at = Location::current());
  PassBuilder& over(TexPart tex);
  PassBuilder& over(uint32_t threads);
  template <class F>
  PassBuilder& draw(const F& callback) {
    return set_draw(DrawCallback(callback));
  }

 private:
  friend class Graph;
  PassBuilder& set_draw(const DrawCallback& callback);
  PassBuilder& add(const char* slot, TexPart tex, Use use, const Clear& clear, Location at);
  PassBuilder& add(const char* slot, Buf buffer, Use use, Location at);
  PassBuilder& add(const UseRow& use);
  void tell_validity();
  Graph& graph_;
  uint32_t pass_;
};

class Graph {
 public:
  explicit Graph(std::span<const HistoryState> histories = {});

  Tex image(const char* name, const ImageDesc& desc, Location at = Location::current());
  Buf buffer(const char* name, uint64_t bytes, Location at = Location::current());
  History history(const char* name, const ImageDesc& desc, Location at = Location::current());
  BufferHistory buffer_history(const char* name, uint64_t bytes, Location at = Location::current());
  // Keeps its content to the next frame that has an image of this name and description, if no frame without it comes in
  // between. Zeros at first.
  Tex keep(const char* name, const ImageDesc& desc, Location at = Location::current());
  // What a layer of a kept image holds, in the words of who draws it: what the last frame that ran has left here; 0
  // when the image is new. It is part of the value that a frame is, not of its topology.
  uint64_t& mark(Tex kept, uint32_t layer);
  Buf import(const char* name, const gpu::Buffer& buffer, Location at = Location::current());
  // In SHADER_READ_ONLY_OPTIMAL, with its whole view (gpu/upload). Sampled only, and as a whole.
  Tex import(const char* name, const gpu::Image& image, Location at = Location::current());
  // A by-product: it is no fault when nothing reads it.
  Tex optional(Tex tex);
  Buf optional(Buf buffer);

  PassBuilder compute(const char* name, gpu::Pipeline pipeline, const char* description = "",
                      Location at = Location::current());
  PassBuilder fullscreen(const char* name, gpu::Pipeline pipeline, const char* description = "",
                         Location at = Location::current());
  PassBuilder raster(const char* name, gpu::Pipeline pipeline, const char* description = "",
                     Location at = Location::current());

  // Copies all mips and layers of equal size and format, or as many bytes as `to` has.
  void copy(const char* name, TexPart from, TexPart to, Location at = Location::current());
  void copy(const char* name, Buf from, Buf to, Location at = Location::current());

  // Copies the first mip and layer of `tex`, or a buffer, to the host; whatever it needs runs. Returns the read-back's
  // number.
  uint32_t readback(const char* name, TexPart tex, Location at = Location::current());
  uint32_t readback(const char* name, Buf buffer, Location at = Location::current());

  // Copies the first mip and layer of `tex` to an image that lives outside the frame, of its size and format, and
  // leaves that in SHADER_READ_ONLY_OPTIMAL, for whoever waits for the frame (ExecuteOptions::then); whatever it needs
  // runs. What the image held is lost. Nobody may be reading it any more. Which image it is is no part of the topology.
  void hand_over(const char* name, TexPart tex, const gpu::Image& to, Location at = Location::current());

  // A block that every shader gets that declares it (the frame's cameras).
  template <class P>
  void share(const P& block, Location at = Location::current()) {
    share_raw(P::table(), &block, at);
  }
  void share_raw(const ParamTable& table, const void* data, Location at);

  // Histories declared from here on are not valid: another technique's past means nothing. What is kept stays: its
  // marks tell what it holds.
  void forget_histories() { forgets_ = true; }

  Tex tex(uint16_t row) const { return {row, serial_}; }
  Buf buf(uint16_t row) const { return {row, serial_}; }
  // Of a handle that is not of this graph: a texel without format. validate() reports its use.
  const ImageDesc& desc(Tex tex) const;

  // The value itself: plain rows, read by compile, dump, the editor.
  std::vector<ResourceRow> resources;
  std::vector<PassRow> passes;
  std::vector<UseRow> uses;
  std::vector<ParamRow> params, shared;
  std::vector<std::byte> param_bytes;
  std::vector<uint64_t> marks;
  uint32_t readbacks = 0;

  std::span<const UseRow> uses_of(const PassRow& pass) const {
    return std::span(uses).subspan(pass.first_use, pass.use_count);
  }

 private:
  friend class PassBuilder;
  PassBuilder add_pass(const char* name, PassKind kind, gpu::Pipeline pipeline, const char* description, Location at);
  uint16_t add_resource(ResourceRow row);
  void pair_histories(uint16_t prev, uint16_t next);
  uint32_t add_param_bytes(const ParamTable& table, const void* data);
  template <class Tag>
  uint16_t row_of(ResourceHandle<Tag> handle, bool is_buffer) const;
  std::span<const HistoryState> histories_;
  bool forgets_ = false;
  uint16_t serial_;
};

// The parameter of `table` that tells a shader whether the history read through `slot` is valid; nullptr: none does.
const Param* find_valid_param(const ParamTable& table, std::string_view slot);
// Texels of a mip.
Size size_of(const ImageDesc& desc, uint32_t mip);

// Hash of everything but parameter values and draw callbacks: equal hash = the same plan fits.
uint64_t topology_hash(const Graph& graph);

}  // namespace nf::graph
