// compile(): a pure function from a Graph to a Plan: culling, order, lifetimes, memory, barriers, load and store. No
// device is needed.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "graph/graph.h"

namespace nf::graph {

// What is wrong with a graph. Every text names pass, slot, resource and the source lines involved.
struct Diagnostic {
  enum class Kind : uint8_t {
    SlotMissing,       // fed, but the shader has no such slot
    SlotNotFed,        // the shader has it, the pass does not feed it
    Direction,         // .in on a writeonly image, .out on a readonly one, a kind of descriptor that does not fit
    FormatMismatch,    // the shader or a copy names another format than the image has
    SizeMismatch,      // attachments, threads, copies differ in size; a part the image does not have
    ReadBeforeWrite,   // nothing wrote the resource in this frame
    WrittenNeverRead,  // no pass or read-back of the graph reads the resource, and it is not optional
    ValidityIgnored,   // a shader reads a history's prev and has no parameter that tells whether it is valid
    UsedTwice,         // a resource used in two ways that exclude each other in one pass
    StaleHandle,       // a handle that is not of this graph
    BlockMismatch,     // a parameter block whose layout in the shader differs from the table
  };
  Kind kind;
  std::string text;
};
std::vector<Diagnostic> validate(const Graph& graph);
// Throws nf::Error (Exit::Internal) with all of them when there are any.
void require_valid(const Graph& graph);

// Of the whole buffer, or of a part of an image. A buffer has no layouts.
struct Barrier {
  uint16_t resource = no_resource;
  Part part;
  VkPipelineStageFlags2 src_stages = 0, dst_stages = 0;
  VkAccessFlags2 src_access = 0, dst_access = 0;
  VkImageLayout old_layout = VK_IMAGE_LAYOUT_UNDEFINED, new_layout = VK_IMAGE_LAYOUT_UNDEFINED;
  bool operator==(const Barrier&) const = default;
};

// Of attachments.
struct PlannedUse {
  VkAttachmentLoadOp load = VK_ATTACHMENT_LOAD_OP_DONT_CARE;
  VkAttachmentStoreOp store = VK_ATTACHMENT_STORE_OP_DONT_CARE;
};

struct PlannedPass {
  uint32_t pass;  // row of Graph::passes
  uint32_t first_barrier = 0, barrier_count = 0;
};

// The layouts that the barriers take a mip of a layer from and leave it in.
struct PlannedCell {
  VkImageLayout before = VK_IMAGE_LAYOUT_UNDEFINED;  // at the frame's start; UNDEFINED: any, the content is discarded
  VkImageLayout after = VK_IMAGE_LAYOUT_UNDEFINED;   // at its end; UNDEFINED: not used in the frame
};

struct PlannedResource {
  bool live = false;
  bool dedicated = false;          // the device wants memory of its own for it: it shares no bytes
  uint32_t first = 0, last = 0;    // positions in Plan::passes
  VkFlags usage = 0;               // of the image or of the buffer
  uint64_t bytes = 0;              // as the device wants them, or of the texels where no device was asked
  int32_t heap = -1;               // row of Plan::heaps; -1: memory of its own (histories, dedicated ones) or imported
  uint64_t offset = 0;             // in the heap
  std::vector<uint16_t> alias_of;  // who owned the bytes before, going round the frame
  uint32_t first_cell = 0;         // in Plan::cells
};

// Transients that can live in the same memory types share a heap; images and buffers have heaps of their own.
struct PlannedHeap {
  bool buffers = false;
  uint32_t type_bits = ~0u;
  uint64_t size = 0;
};

struct Plan {
  LayoutPolicy layouts = LayoutPolicy::Exact;
  std::vector<PlannedPass> passes;  // live ones, in order
  std::vector<bool> culled;         // by row of Graph::passes
  std::vector<Barrier> barriers;
  std::vector<PlannedUse> uses;  // by row of Graph::uses
  std::vector<PlannedResource> resources;
  std::vector<PlannedCell> cells;
  std::vector<PlannedHeap> heaps;
  uint64_t unaliased_bytes = 0;  // sum over live transients
  // What the transients alive at one pass need at most: the bound for any placement in these heaps.
  uint64_t max_live_bytes = 0;
  uint64_t placed_bytes = 0;  // what the heaps and the dedicated transients really take
};

struct CompileOptions {
  bool alias = true;  // transients share bytes where their lifetimes allow it
  LayoutPolicy layouts = LayoutPolicy::Exact;
  uint64_t order_seed = 0;  // not 0: a random order of passes that keeps every dependency, the same for the same seed
  // What the device asks for a resource with this usage; without it the texels and bytes count, unaligned.
  std::function<gpu::MemoryNeeds(const ResourceRow&, VkFlags usage)> needs;
};
// The graph must have passed validate().
Plan compile(const Graph& graph, const CompileOptions& options = {});

}  // namespace nf::graph
