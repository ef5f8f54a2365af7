// The frame graph as a value: rows for resources, passes and uses. Building one makes no Vulkan call; compile()
// (plan.h) turns it into a Plan, execute() (executor.h) runs that. Declared order is execution order.
//
//   Tex visibility = graph.image("gtao.visibility", {size, VK_FORMAT_R16_SFLOAT});
//   graph.compute("gtao.trace", trace_pipeline, "Horizon search along slices")
//       .in("depth", gbuffer.depth).in("normal", gbuffer.normal).out("visibility",
//       visibility).params(settings).over(visibility);
//
// Names are string literals (or live as long as the graph): they are kept as pointers.
#pragma once

#include <cstring>
#include <span>
#include <type_traits>
#include <vector>

#include "core/params.h"
#include "gpu/memory.h"
#include "gpu/pipeline.h"
#include "graph/access.h"

namespace nf::graph {

struct TexTag;
struct BufTag;
using Tex = Handle<TexTag>;
using Buf = Handle<BufTag>;

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

struct ImageDesc {
  Size size;
  VkFormat format = VK_FORMAT_UNDEFINED;
  uint8_t mips = 1, layers = 1;
  bool operator==(const ImageDesc&) const = default;
};

// prev is what the last frame wrote to next. valid is false when there is no such frame: prev then reads as zeros.
struct History {
  Tex prev, next;
  bool valid = false;
};

// What the executor remembers between frames: which histories were written by the last frame.
struct HistoryState {
  const char* name;
  ImageDesc desc;
  bool written;
};

struct Clear {
  bool clear = false;
  float color[4] = {0, 0, 0, 0};
};

enum class Lifetime : uint8_t { Transient, HistoryPrev, HistoryNext };

struct ResourceRow {
  const char* name;
  ImageDesc desc;
  Lifetime lifetime;
  uint16_t pair;  // HistoryPrev <-> HistoryNext
  Location at;
};

// A buffer that lives outside the frame and is only read in it (scene tables).
struct BufferRow {
  const char* name;
  const gpu::Buffer* buffer;
  Location at;
};

inline constexpr uint16_t no_resource = 0xffff;

struct UseRow {
  const char* slot;   // the shader's name for it; nullptr for depth attachments and read-backs
  uint16_t resource;  // row of resources, or of buffers when `is_buffer`
  Use use;
  bool is_buffer;
  Clear clear;
  Location at;
};

struct ParamRow {
  const ParamTable* table;
  uint32_t offset;  // into param_bytes
  Location at;
};

// Records draws of a raster pass. Has no barriers: those are the graph's.
struct Recorder {
  VkCommandBuffer commands;
  VkPipelineLayout layout;
  void bind_vertex_streams(std::span<const VkBuffer> buffers) const;
  void bind_indices(VkBuffer buffer) const;  // 32-bit
  void bind_set1(VkDescriptorSet set) const;
  void set_cull(VkCullModeFlags mode, VkFrontFace front) const;
  void draw_indexed_indirect(VkBuffer buffer, VkDeviceSize offset, uint32_t count) const;
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
  uint16_t over = no_resource;  // compute: the image whose texels are the threads
  DrawCallback draw;
  Location at;
};

class Graph;

// Adds uses to the pass that was added last.
class PassBuilder {
 public:
  PassBuilder(Graph& graph, uint32_t pass) : graph_(graph), pass_(pass) {}
  PassBuilder& in(const char* slot, Tex tex, Location at = Location::current());
  PassBuilder& in(const char* slot, Buf buffer, Location at = Location::current());
  // Compute: a storage image. Full-screen and raster: the fragment output of this name.
  PassBuilder& out(const char* slot, Tex tex, Location at = Location::current());
  PassBuilder& out(const char* slot, Tex tex, std::array<float, 4> clear, Location at = Location::current());
  PassBuilder& inout(const char* slot, Tex tex, Location at = Location::current());
  PassBuilder& depth(Tex tex, Location at = Location::current());
  PassBuilder& depth(Tex tex, float clear, Location at = Location::current());
  template <class P>
  PassBuilder& params(const P& block, Location at = Location::current()) {
    return params_raw(P::table(), &block, at);
  }
  PassBuilder& params_raw(const ParamTable& table, const void* data, Location at = Location::current());
  PassBuilder& over(Tex tex);
  template <class F>
  PassBuilder& draw(const F& callback) {
    return set_draw(DrawCallback(callback));
  }

 private:
  PassBuilder& set_draw(const DrawCallback& callback);
  PassBuilder& add(UseRow use);
  Graph& graph_;
  uint32_t pass_;
};

class Graph {
 public:
  explicit Graph(std::span<const HistoryState> histories = {}) : histories_(histories) {}

  Tex image(const char* name, const ImageDesc& desc, Location at = Location::current());
  History history(const char* name, const ImageDesc& desc, Location at = Location::current());
  Buf import(const char* name, const gpu::Buffer& buffer, Location at = Location::current());

  PassBuilder compute(const char* name, gpu::Pipeline pipeline, const char* description = "",
                      Location at = Location::current());
  PassBuilder fullscreen(const char* name, gpu::Pipeline pipeline, const char* description = "",
                         Location at = Location::current());
  PassBuilder raster(const char* name, gpu::Pipeline pipeline, const char* description = "",
                     Location at = Location::current());

  // Keeps `tex` alive to the frame's end and copies it to the host. The returned number is the read-back's.
  uint32_t readback(const char* name, Tex tex, Location at = Location::current());

  // A block that every shader gets that declares it (the frame's cameras).
  template <class P>
  void share(const P& block, Location at = Location::current()) {
    share_raw(P::table(), &block, at);
  }
  void share_raw(const ParamTable& table, const void* data, Location at);

  const ImageDesc& desc(Tex tex) const { return resources[tex.id].desc; }

  // The value itself: plain rows, read by compile, dump, the editor.
  std::vector<ResourceRow> resources;
  std::vector<BufferRow> buffers;
  std::vector<PassRow> passes;
  std::vector<UseRow> uses;
  std::vector<ParamRow> params, shared;
  std::vector<std::byte> param_bytes;
  uint32_t readbacks = 0;

 private:
  friend class PassBuilder;
  PassBuilder add_pass(const char* name, PassKind kind, gpu::Pipeline pipeline, const char* description, Location at);
  uint32_t add_param_bytes(const ParamTable& table, const void* data);
  std::span<const HistoryState> histories_;
};

// Hash of everything but parameter values and draw callbacks: equal hash = the same plan fits.
uint64_t topology_hash(const Graph& graph);

}  // namespace nf::graph
