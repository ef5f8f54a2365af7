// Valid frame graphs of every kind of resource, use and pass, from a seed; and sizes as a device would give them.
#pragma once

#include <cmath>
#include <random>
#include <set>

#include "graph_values.h"

namespace nf::graph {

// 5 to 60 resources: images of log-uniform sizes with mips and layers, depth images, buffers, histories of both, kept
// images;
// compute, full-screen and raster passes, copies, indirect dispatches, read-backs.
class RandomGraph {
 public:
  explicit RandomGraph(uint64_t seed) : random_(seed) {
    const int count = pick(5, 60);
    while (int(graph.resources.size()) < count) add_resource();
    const int passes = pick(count, 2 * count + 5);
    for (int i = 0; i < passes; ++i) {
      if (pick(0, 9) == 0) add_readback();
      switch (pick(0, 7)) {
        case 0:
          add_copy();
          break;
        case 1:
        case 2:
          add_draw();
          break;
        default:
          add_compute();
      }
    }
    finish_histories();
    for (int i = pick(1, 2 + count / 4); i > 0; --i) add_readback();
  }
  Graph graph;

 private:
  int pick(int low, int high) { return low + int(random_() % uint64_t(high - low + 1)); }
  const char* name(const char* kind) {
    return names_.emplace_back(std::string(kind) + std::to_string(names_.size())).c_str();
  }
  const ResourceRow& row(uint16_t r) const { return graph.resources[r]; }
  Tex tex(uint16_t r) const { return graph.tex(r); }
  Buf buf(uint16_t r) const { return graph.buf(r); }

  void add_resource() {
    const int kind = pick(0, 9);
    if (pick(0, 19) == 0) {
      track(graph.keep(name("kept"), any_desc(pick(0, 2) == 0)).id);
    } else if (kind < 6) {
      const ImageDesc desc = any_desc(pick(0, 5) == 0);
      track(graph.image(name("image"), desc).id);
    } else if (kind < 8) {
      track(graph.buffer(name("buffer"), any_bytes()).id);
    } else if (kind < 9) {
      const History h = graph.history(name("history"), any_desc(false));
      track(h.prev.id), track(h.next.id);
    } else {
      const BufferHistory h = graph.buffer_history(name("list"), any_bytes());
      track(h.prev.id), track(h.next.id);
    }
  }
  ImageDesc any_desc(bool depth) {
    const double u = double(random_() % 10000) / 10000;
    const uint32_t side = uint32_t(std::exp(u * std::log(64.0)) * 16);  // 16 to 1024
    ImageDesc desc{{side, side}, depth ? VK_FORMAT_D32_SFLOAT : VK_FORMAT_R32_SFLOAT};
    if (depth) return desc;
    if (pick(0, 4) == 0) desc.mips = uint8_t(pick(2, 4));
    if (pick(0, 6) == 0) desc.layers = uint8_t(pick(2, 3));
    return desc;
  }
  uint64_t any_bytes() { return 16 * uint64_t(std::exp(double(random_() % 10000) / 10000 * std::log(4096.0))); }
  void track(uint16_t r) {
    const bool there = row(r).lifetime == Lifetime::HistoryPrev || row(r).lifetime == Lifetime::Kept;
    written_.emplace_back(cell_count(row(r)), there);
  }

  bool written(uint16_t r, const Part& part) const {
    bool all = true;
    for_each(r, part, [&](uint32_t cell) { all &= written_[r][cell]; });
    return all;
  }
  template <class F>
  void for_each(uint16_t r, const Part& part, F&& f) const {
    for (uint32_t l = part.layer; l < uint32_t(part.layer + part.layers); ++l)
      for (uint32_t m = part.mip; m < uint32_t(part.mip + part.mips); ++m) f(l * row(r).desc.mips + m);
  }
  void mark(uint16_t r, const Part& part) {
    for_each(r, part, [&](uint32_t cell) { written_[r][cell] = true; });
  }
  // One cell, or a mip of all layers, or everything.
  Part any_part(uint16_t r, bool one_cell) {
    const ImageDesc& desc = row(r).desc;
    if (row(r).is_buffer) return {0, 1, 0, 1};
    Part part{0, desc.mips, 0, desc.layers};
    if (one_cell || pick(0, 2)) part.mip = uint8_t(pick(0, desc.mips - 1)), part.mips = 1;
    if (one_cell || pick(0, 2)) part.layer = uint8_t(pick(0, desc.layers - 1)), part.layers = 1;
    return part;
  }
  bool writable(uint16_t r) const { return row(r).lifetime != Lifetime::HistoryPrev; }
  bool is_depth(uint16_t r) const { return row(r).desc.format == VK_FORMAT_D32_SFLOAT; }
  uint16_t any() { return uint16_t(pick(0, int(graph.resources.size()) - 1)); }
  Size size(uint16_t r, const Part& part) const { return size_of(row(r).desc, part.mip); }

  struct Picked {
    uint16_t resource;
    Part part;
  };
  // Cells of a resource that this pass does not use yet.
  bool fresh(const Picked& p) {
    for (const Picked& other : used_)
      if (other.resource == p.resource && (row(p.resource).is_buffer || overlap(other.part, p.part))) return false;
    used_.push_back(p);
    return true;
  }

  // Inputs of a pass with a shader; their slots go to `slots`.
  std::vector<Picked> pick_inputs(std::vector<gpu::Slot>& slots) {
    std::vector<Picked> in;
    for (int i = pick(0, 8); i > 0; --i) {
      const uint16_t r = any();
      const Picked p{r, any_part(r, false)};
      if (!written(r, p.part) || !fresh(p)) continue;
      gpu::Slot slot = sampled("in" + std::to_string(in.size()));
      if (row(r).is_buffer)
        slot.kind = gpu::SlotKind::StorageBuffer, slot.readonly = true;
      else if (p.part.mips == 1 && !is_depth(r) && pick(0, 1))
        slot = storage_in(slot.name);
      if (p.part.layers > 1) slot.shape = gpu::SlotShape::Array;
      slots.push_back(slot);
      in.push_back(p);
    }
    return in;
  }
  void feed(PassBuilder& pass, const std::vector<Picked>& in) {
    for (size_t i = 0; i < in.size(); ++i) {
      const char* slot = names_.emplace_back("in" + std::to_string(i)).c_str();
      row(in[i].resource).is_buffer ? pass.in(slot, buf(in[i].resource))
                                    : pass.in(slot, TexPart{tex(in[i].resource), in[i].part});
    }
  }

  void add_compute(uint16_t wanted = no_resource, Part wanted_part = {}) {
    used_.clear();
    const uint16_t r = wanted != no_resource ? wanted : any();
    if (!writable(r) || is_depth(r)) return;
    Part part = wanted != no_resource ? wanted_part : any_part(r, false);
    part.mips = 1;
    const Picked out{r, part};
    fresh(out);
    const bool rewrite = wanted == no_resource && written(r, part) && pick(0, 3) == 0;
    std::vector<gpu::Slot> slots;
    const std::vector<Picked> in = pick_inputs(slots);
    gpu::Slot target = rewrite ? storage_inout("out") : storage_out("out");
    if (row(r).is_buffer) target.kind = gpu::SlotKind::StorageBuffer;
    if (part.layers > 1) target.shape = gpu::SlotShape::Array;
    slots.push_back(target);
    // Threads from an image, or from arguments that another pass has written.
    uint16_t arguments = no_resource;
    if (const uint16_t a = any();
        pick(0, 2) == 0 && row(a).is_buffer && written(a, {0, 1, 0, 1}) && fresh({a, {0, 1, 0, 1}}))
      arguments = a;
    uint16_t area = r;
    if (row(r).is_buffer)
      for (area = 0; area < graph.resources.size() && row(area).is_buffer;) ++area;
    if (arguments == no_resource && area == graph.resources.size()) return;
    PassBuilder pass = graph.compute(name("compute"), shaders_.make(slots));
    feed(pass, in);
    if (row(r).is_buffer)
      rewrite ? pass.inout("out", buf(r)) : pass.out("out", buf(r));
    else
      rewrite ? pass.inout("out", TexPart{tex(r), part}) : pass.out("out", TexPart{tex(r), part});
    if (arguments != no_resource)
      pass.indirect(buf(arguments));
    else
      pass.over(TexPart{tex(area), area == r ? part : Part{0, 1, 0, 1}});
    mark(r, part);
  }

  void add_draw() {
    used_.clear();
    const uint16_t r = any();
    if (!writable(r) || row(r).is_buffer || is_depth(r)) return;
    const Part part = any_part(r, true);
    fresh({r, part});
    uint16_t depth = any();
    if (!is_depth(depth) || size(depth, {0, 1, 0, 1}) != size(r, part) || !fresh({depth, {0, 1, 0, 1}}))
      depth = no_resource;
    std::vector<gpu::Slot> slots;
    const std::vector<Picked> in = pick_inputs(slots);
    const gpu::Pipeline pipeline = shaders_.make(slots, {"color"});
    const bool raster = depth != no_resource || pick(0, 1);
    PassBuilder pass = raster ? graph.raster(name("raster"), pipeline) : graph.fullscreen(name("fullscreen"), pipeline);
    feed(pass, in);
    const TexPart target{tex(r), part};
    pick(0, 2) ? pass.out("color", target) : pass.out("color", target, {0, 0, 0, 0});
    if (const uint16_t i = any(); raster && row(i).is_buffer && written(i, {0, 1, 0, 1}) && fresh({i, {0, 1, 0, 1}}))
      pass.indices(buf(i));
    if (depth != no_resource) {
      written(depth, {0, 1, 0, 1}) && pick(0, 1) ? pass.depth(tex(depth)) : pass.depth(tex(depth), 0.0f);
      mark(depth, {0, 1, 0, 1});
    }
    mark(r, part);
  }

  void add_copy() {
    for (int tries = 0; tries < 20; ++tries) {
      const uint16_t from = any(), to = any();
      if (from == to || !writable(to) || row(from).is_buffer != row(to).is_buffer) continue;
      if (row(from).is_buffer) {
        if (row(from).bytes < row(to).bytes || !written(from, {0, 1, 0, 1})) continue;
        graph.copy(name("copy"), buf(from), buf(to));
        return mark(to, {0, 1, 0, 1});
      }
      const Part a = any_part(from, true), b = any_part(to, true);
      if (row(from).desc.format != row(to).desc.format || size(from, a) != size(to, b) || !written(from, a)) continue;
      graph.copy(name("copy"), TexPart{tex(from), a}, TexPart{tex(to), b});
      return mark(to, b);
    }
  }

  void add_readback() {
    for (int tries = 0; tries < 20; ++tries) {
      const uint16_t r = any();
      const Part part = any_part(r, true);
      if (!written(r, part)) continue;
      row(r).is_buffer ? graph.readback(name("readback"), buf(r))
                       : graph.readback(name("readback"), TexPart{tex(r), part});
      return;
    }
  }

  // A history that is read must be written.
  void finish_histories() {
    for (uint16_t r = 0; r < graph.resources.size(); ++r) {
      if (row(r).lifetime != Lifetime::HistoryNext) continue;
      for (uint8_t layer = 0; layer < row(r).desc.layers; ++layer)
        for (uint8_t mip = 0; mip < row(r).desc.mips; ++mip)
          while (!written(r, {mip, 1, layer, 1})) {
            if (row(r).is_buffer && !has_image()) graph.image(name("area"), {{16, 16}, VK_FORMAT_R32_SFLOAT});
            written_.resize(graph.resources.size(), {false});
            add_compute(r, {mip, 1, layer, 1});
          }
    }
  }
  bool has_image() const {
    for (const ResourceRow& r : graph.resources)
      if (!r.is_buffer) return true;
    return false;
  }

  std::mt19937_64 random_;
  Shaders shaders_;
  std::deque<std::string> names_;
  std::vector<std::vector<bool>> written_;  // by resource and cell
  std::vector<Picked> used_;                // by the pass being made
};

// Sizes, mixed alignments and memory types as a device might ask for, the same for the same row. `padded`: more bytes
// than the texels take.
inline gpu::MemoryNeeds device_needs(const ResourceRow& row, bool padded) {
  uint64_t hash = 1469598103934665603ull;
  for (const char* c = row.name; *c; ++c) hash = (hash ^ uint8_t(*c)) * 1099511628211ull;
  gpu::MemoryNeeds needs;
  needs.alignment = uint64_t{1} << (hash >> 20) % 17;
  needs.type_bits = (hash >> 40) % 8 ? 3u : 1u;
  needs.dedicated = (hash >> 50) % 16 == 0;
  if (row.is_buffer) {
    needs.size = row.bytes;
  } else {
    for (uint32_t mip = 0; mip < row.desc.mips; ++mip) {
      const Size size = size_of(row.desc, mip);
      needs.size += uint64_t(size.width) * size.height * row.desc.layers * gpu::texel_bytes(row.desc.format);
    }
  }
  if (padded) needs.size += (hash >> 30) % 5000;
  return needs;
}

}  // namespace nf::graph
