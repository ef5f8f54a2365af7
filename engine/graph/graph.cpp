// Building of the graph value.
#include "graph/graph.h"

#include <algorithm>
#include <array>
#include <atomic>

namespace nf::graph {

Graph::Graph(std::span<const HistoryState> histories) : histories_(histories) {
  static std::atomic<uint16_t> graphs = 0;
  serial_ = ++graphs;
}

uint16_t Graph::add_resource(ResourceRow row) {
  NF_CHECK(resources.size() < no_resource, "{} resources", resources.size());
  resources.push_back(row);
  return uint16_t(resources.size() - 1);
}

Tex Graph::image(const char* name, const ImageDesc& desc, Location at) {
  return {add_resource({.name = name, .desc = desc, .at = at}), serial_};
}

Buf Graph::buffer(const char* name, uint64_t bytes, Location at) {
  return {add_resource({.name = name, .is_buffer = true, .desc = {}, .bytes = bytes, .at = at}), serial_};
}

Buf Graph::import(const char* name, const gpu::Buffer& buffer, Location at) {
  return {add_resource({.name = name,
                        .is_buffer = true,
                        .lifetime = Lifetime::Imported,
                        .desc = {},
                        .bytes = buffer.size,
                        .imported = &buffer,
                        .at = at}),
          serial_};
}

Tex Graph::import(const char* name, const gpu::Image& image, Location at) {
  const gpu::ImageInfo& info = image.info;
  return {add_resource(
              {.name = name,
               .lifetime = Lifetime::Imported,
               .desc = {{info.extent.width, info.extent.height}, info.format, uint8_t(info.mips), uint8_t(info.layers)},
               .imported_image = &image,
               .at = at}),
          serial_};
}

void Graph::pair_histories(uint16_t prev, uint16_t next) {
  ResourceRow &before = resources[prev], &after = resources[next];
  before.lifetime = Lifetime::HistoryPrev;
  after.lifetime = Lifetime::HistoryNext;
  before.pair = next;
  after.pair = prev;
  for (const HistoryState& state : histories_)
    before.valid |= !forgets_ && state.desc == before.desc && state.bytes == before.bytes && state.name == before.name;
}

// `given` may be a row's own, and rows move when one is added.
History Graph::history(const char* name, const ImageDesc& given, Location at) {
  const ImageDesc desc = given;
  const Tex prev = image(name, desc, at), next = image(name, desc, at);
  pair_histories(prev.id, next.id);
  return {prev, next, resources[prev.id].valid};
}

BufferHistory Graph::buffer_history(const char* name, uint64_t bytes, Location at) {
  const Buf prev = buffer(name, bytes, at), next = buffer(name, bytes, at);
  pair_histories(prev.id, next.id);
  return {prev, next, resources[prev.id].valid};
}

template <class Tag>
uint16_t Graph::row_of(ResourceHandle<Tag> handle, bool is_buffer) const {
  const bool ours =
      handle.graph == serial_ && handle.id < resources.size() && resources[handle.id].is_buffer == is_buffer;
  return ours ? handle.id : no_resource;
}

Tex Graph::keep(const char* name, const ImageDesc& given, Location at) {
  const ImageDesc desc = given;
  const Tex tex = image(name, desc, at);
  ResourceRow& row = resources[tex.id];
  row.lifetime = Lifetime::Kept;
  row.first_mark = uint32_t(marks.size());
  marks.resize(marks.size() + desc.layers, 0);
  for (const HistoryState& state : histories_) {
    if (state.desc != desc || state.marks.size() != desc.layers || state.name != name) continue;
    row.valid = true;
    std::copy(state.marks.begin(), state.marks.end(), marks.begin() + row.first_mark);
  }
  return tex;
}

uint64_t& Graph::mark(Tex kept, uint32_t layer) {
  const uint16_t row = row_of(kept, false);
  NF_CHECK(row != no_resource && resources[row].lifetime == Lifetime::Kept && layer < resources[row].desc.layers,
           "layer {} of an image that is not kept or has fewer", layer);
  return marks[resources[row].first_mark + layer];
}

Tex Graph::optional(Tex tex) {
  if (const uint16_t row = row_of(tex, false); row != no_resource) resources[row].optional = true;
  return tex;
}

Buf Graph::optional(Buf buffer) {
  if (const uint16_t row = row_of(buffer, true); row != no_resource) resources[row].optional = true;
  return buffer;
}

const ImageDesc& Graph::desc(Tex tex) const {
  static const ImageDesc nothing;
  const uint16_t row = row_of(tex, false);
  return row == no_resource ? nothing : resources[row].desc;
}

PassBuilder Graph::add_pass(const char* name, PassKind kind, gpu::Pipeline pipeline, const char* description,
                            Location at) {
  passes.push_back({.name = name,
                    .description = description,
                    .kind = kind,
                    .pipeline = pipeline,
                    .first_use = uint32_t(uses.size()),
                    .first_param = uint32_t(params.size()),
                    .over_part = {},
                    .draw = {},
                    .at = at});
  return PassBuilder(*this, uint32_t(passes.size() - 1));
}

PassBuilder Graph::compute(const char* name, gpu::Pipeline pipeline, const char* description, Location at) {
  return add_pass(name, PassKind::Compute, pipeline, description, at);
}
PassBuilder Graph::fullscreen(const char* name, gpu::Pipeline pipeline, const char* description, Location at) {
  return add_pass(name, PassKind::Fullscreen, pipeline, description, at);
}
PassBuilder Graph::raster(const char* name, gpu::Pipeline pipeline, const char* description, Location at) {
  return add_pass(name, PassKind::Raster, pipeline, description, at);
}

void Graph::copy(const char* name, TexPart from, TexPart to, Location at) {
  add_pass(name, PassKind::Copy, {}, "Copy", at)
      .add(nullptr, from, Use::CopySource, {}, at)
      .add(nullptr, to, Use::CopyDestination, {}, at);
}
void Graph::copy(const char* name, Buf from, Buf to, Location at) {
  add_pass(name, PassKind::Copy, {}, "Copy", at)
      .add(nullptr, from, Use::CopySource, at)
      .add(nullptr, to, Use::CopyDestination, at);
}

uint32_t Graph::readback(const char* name, TexPart tex, Location at) {
  const TexPart one{tex.tex, {tex.part.mip, 1, tex.part.layer, 1}};
  add_pass(name, PassKind::Readback, {}, "Copy to the host", at).add(nullptr, one, Use::CopySource, {}, at);
  return readbacks++;
}
uint32_t Graph::readback(const char* name, Buf buffer, Location at) {
  add_pass(name, PassKind::Readback, {}, "Copy to the host", at).add(nullptr, buffer, Use::CopySource, at);
  return readbacks++;
}

void Graph::hand_over(const char* name, TexPart tex, const gpu::Image& to, Location at) {
  const TexPart one{tex.tex, {tex.part.mip, 1, tex.part.layer, 1}};
  add_pass(name, PassKind::HandOver, {}, "Copy to an image outside the frame", at)
      .add(nullptr, one, Use::CopySource, {}, at);
  passes.back().target = &to;
}

uint32_t Graph::add_param_bytes(const ParamTable& table, const void* data) {
  const uint32_t offset = uint32_t(param_bytes.size());
  const auto* bytes = static_cast<const std::byte*>(data);
  param_bytes.insert(param_bytes.end(), bytes, bytes + table.size);
  return offset;
}

void Graph::share_raw(const ParamTable& table, const void* data, Location at) {
  shared.push_back({&table, add_param_bytes(table, data), at});
}

PassBuilder& PassBuilder::add(const UseRow& use) {
  PassRow& pass = graph_.passes[pass_];
  NF_CHECK(pass.first_use + pass.use_count == graph_.uses.size(), "uses of {} must be added before the next pass",
           pass.name);
  graph_.uses.push_back(use);
  ++pass.use_count;
  tell_validity();
  return *this;
}

PassBuilder& PassBuilder::add(const char* slot, TexPart tex, Use use, const Clear& clear, Location at) {
  const ImageDesc& desc = graph_.desc(tex.tex);
  Part part = tex.part;
  if (part.mips == Part::all) part.mips = uint8_t(std::max(desc.mips - part.mip, 1));
  if (part.layers == Part::all) part.layers = uint8_t(std::max(desc.layers - part.layer, 1));
  return add({slot, graph_.row_of(tex.tex, false), use, part, clear, at});
}
PassBuilder& PassBuilder::add(const char* slot, Buf buffer, Use use, Location at) {
  return add({slot, graph_.row_of(buffer, true), use, {0, 1, 0, 1}, {}, at});
}

// Whether an input is read as a storage image or sampled is the shader's word; the interface tells. A slot the shader
// does not have keeps SampledImage and is reported by validate().
PassBuilder& PassBuilder::in(const char* slot, TexPart tex, Location at) {
  const gpu::Slot* found = graph_.passes[pass_].pipeline.interface->find(slot);
  const bool storage = found && found->kind == gpu::SlotKind::StorageImage;
  return add(slot, tex, storage ? Use::StorageImageRead : Use::SampledImage, {}, at);
}

PassBuilder& PassBuilder::in(const char* slot, Buf buffer, Location at) {
  return add(slot, buffer, Use::StorageBufferRead, at);
}

PassBuilder& PassBuilder::out(const char* slot, TexPart tex, Location at) {
  const bool storage = graph_.passes[pass_].kind == PassKind::Compute;
  return add(slot, tex, storage ? Use::StorageImageWrite : Use::ColorAttachment, {}, at);
}

PassBuilder& PassBuilder::out(const char* slot, TexPart tex, std::array<float, 4> clear, Location at) {
  return add(slot, tex, Use::ColorAttachment, {true, {clear[0], clear[1], clear[2], clear[3]}}, at);
}
PassBuilder& PassBuilder::out(const char* slot, Buf buffer, Location at) {
  return add(slot, buffer, Use::StorageBufferWrite, at);
}

PassBuilder& PassBuilder::inout(const char* slot, TexPart tex, Location at) {
  return add(slot, tex, Use::StorageImageReadWrite, {}, at);
}
PassBuilder& PassBuilder::inout(const char* slot, Buf buffer, Location at) {
  return add(slot, buffer, Use::StorageBufferReadWrite, at);
}
PassBuilder& PassBuilder::depth(TexPart tex, Location at) {
  return add(nullptr, tex, Use::DepthAttachment, {}, at);
}
PassBuilder& PassBuilder::depth(TexPart tex, float clear, Location at) {
  return add(nullptr, tex, Use::DepthAttachment, {true, {clear, 0, 0, 0}}, at);
}
PassBuilder& PassBuilder::indirect(Buf buffer, uint64_t offset, Location at) {
  graph_.passes[pass_].argument_offset = offset;
  return add(nullptr, buffer, Use::IndirectArguments, at);
}
PassBuilder& PassBuilder::indices(Buf buffer, Location at) {
  return add(nullptr, buffer, Use::Indices, at);
}

PassBuilder& PassBuilder::params_raw(const ParamTable& table, const void* data, Location at) {
  graph_.params.push_back({&table, graph_.add_param_bytes(table, data), at});
  ++graph_.passes[pass_].param_count;
  tell_validity();
  return *this;
}

// A shader that reads last frame's side of a history through the slot "x" is told by its parameter "x_valid" whether
// there was a last frame.
void PassBuilder::tell_validity() {
  const PassRow& pass = graph_.passes[pass_];
  for (const UseRow& use : graph_.uses_of(pass)) {
    if (!use.slot || use.resource == no_resource) continue;
    const ResourceRow& row = graph_.resources[use.resource];
    if (row.lifetime != Lifetime::HistoryPrev) continue;
    for (uint32_t i = 0; i < pass.param_count; ++i) {
      const ParamRow& params = graph_.params[pass.first_param + i];
      const Param* told = find_valid_param(*params.table, use.slot);
      const uint32_t valid = row.valid;
      if (told) std::memcpy(graph_.param_bytes.data() + params.offset + told->offset, &valid, sizeof valid);
    }
  }
}

PassBuilder& PassBuilder::over(TexPart tex) {
  PassRow& pass = graph_.passes[pass_];
  pass.over = graph_.row_of(tex.tex, false);
  const ImageDesc& desc = graph_.desc(tex.tex);
  pass.over_part = tex.part;
  if (tex.part.layers == Part::all) pass.over_part.layers = uint8_t(std::max(desc.layers - tex.part.layer, 1));
  pass.over_part.mips = 1;
  pass.has_over = true;
  return *this;
}

PassBuilder& PassBuilder::over(uint32_t threads) {
  graph_.passes[pass_].threads = threads;
  return *this;
}

PassBuilder& PassBuilder::set_draw(const DrawCallback& callback) {
  graph_.passes[pass_].draw = callback;
  return *this;
}

const Param* find_valid_param(const ParamTable& table, std::string_view slot) {
  for (const Param& param : table.params) {
    const std::string_view name = param.name;
    if (param.size == sizeof(uint32_t) && name.size() == slot.size() + 6 && name.starts_with(slot) &&
        name.ends_with("_valid"))
      return &param;
  }
  return nullptr;
}

Size size_of(const ImageDesc& desc, uint32_t mip) {
  return {std::max(desc.size.width >> mip, 1u), std::max(desc.size.height >> mip, 1u)};
}

uint64_t topology_hash(const Graph& graph) {
  uint64_t hash = 1469598103934665603ull;
  const auto mix = [&](uint64_t value) {
    hash = (hash ^ value) * 0x9E3779B97F4A7C15ull;
    hash ^= hash >> 29;
  };
  const auto mix_text = [&](const char* text) {
    size_t length = text ? std::strlen(text) : 0;
    mix(length);
    for (uint64_t word; length > 0; text += std::min<size_t>(length, 8), length -= std::min<size_t>(length, 8)) {
      word = 0;
      std::memcpy(&word, text, std::min<size_t>(length, 8));
      mix(word);
    }
  };
  const auto part_bits = [](const Part& p) {
    return uint64_t(p.mip) << 24 | uint64_t(p.mips) << 16 | uint64_t(p.layer) << 8 | p.layers;
  };
  for (const ResourceRow& r : graph.resources) {
    mix_text(r.name);
    mix(uint64_t(r.desc.size.width) << 32 | r.desc.size.height);
    mix(uint64_t(r.desc.format) << 32 | uint64_t(r.desc.mips) << 24 | uint64_t(r.desc.layers) << 16 |
        uint64_t(r.lifetime) << 8 | uint64_t(r.is_buffer) << 1 | uint64_t(r.optional));
    mix(r.lifetime != Lifetime::Imported ? r.bytes : r.imported_image ? uint64_t(r.imported_image->whole) : 0);
  }
  for (const PassRow& p : graph.passes) {
    mix_text(p.name);
    mix(uint64_t(p.kind) << 48 | uint64_t(p.pipeline.id.id) << 32 | uint64_t(p.use_count) << 16 | p.param_count);
    mix(uint64_t(p.over) << 32 | part_bits(p.over_part));
    mix(p.pipeline.interface ? p.pipeline.interface->generation : 0);
    mix(p.one_texel);
  }
  for (const UseRow& u : graph.uses) {
    mix_text(u.slot);
    mix(uint64_t(u.resource) << 48 | uint64_t(u.use) << 40 | uint64_t(u.clear.clear) << 32 | part_bits(u.part));
    if (!u.clear.clear) continue;
    uint64_t bits[2];
    std::memcpy(bits, u.clear.color, sizeof bits);
    mix(bits[0]), mix(bits[1]);
  }
  for (const ParamRow& p : graph.params) mix_text(p.table->prefix);
  for (const ParamRow& p : graph.shared) mix_text(p.table->prefix);
  return hash;
}

}  // namespace nf::graph
