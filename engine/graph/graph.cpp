// Building of the graph value.
#include "graph/graph.h"

#include <array>

namespace nf::graph {

Tex Graph::image(const char* name, const ImageDesc& desc, Location at) {
  NF_CHECK(resources.size() < no_resource, "{} resources", resources.size());
  resources.push_back({name, desc, Lifetime::Transient, no_resource, at});
  return Tex{uint16_t(resources.size() - 1)};
}

History Graph::history(const char* name, const ImageDesc& desc, Location at) {
  const Tex prev = image(name, desc, at), next = image(name, desc, at);
  resources[prev.id].lifetime = Lifetime::HistoryPrev;
  resources[prev.id].pair = next.id;
  resources[next.id].lifetime = Lifetime::HistoryNext;
  resources[next.id].pair = prev.id;
  bool valid = false;
  for (const HistoryState& state : histories_)
    valid |= state.written && state.desc == desc && !std::strcmp(state.name, name);
  return {prev, next, valid};
}

Buf Graph::import(const char* name, const gpu::Buffer& buffer, Location at) {
  buffers.push_back({name, &buffer, at});
  return Buf{uint16_t(buffers.size() - 1)};
}

PassBuilder Graph::add_pass(const char* name, PassKind kind, gpu::Pipeline pipeline, const char* description,
                            Location at) {
  passes.push_back({.name = name,
                    .description = description,
                    .kind = kind,
                    .pipeline = pipeline,
                    .first_use = uint32_t(uses.size()),
                    .first_param = uint32_t(params.size()),
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

uint32_t Graph::readback(const char* name, Tex tex, Location at) {
  add_pass(name, PassKind::Readback, {}, "Copy to the host", at);
  uses.push_back({nullptr, tex.id, Use::CopySource, false, {}, at});
  passes.back().use_count = 1;
  return readbacks++;
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

PassBuilder& PassBuilder::add(UseRow use) {
  PassRow& pass = graph_.passes[pass_];
  NF_CHECK(pass.first_use + pass.use_count == graph_.uses.size(), "uses of {} must be added before the next pass",
           pass.name);
  graph_.uses.push_back(use);
  ++pass.use_count;
  return *this;
}

// Whether an input is read as a storage image or sampled is the shader's word; the interface tells. A slot the shader
// does not have keeps SampledImage and is reported by validate().
PassBuilder& PassBuilder::in(const char* slot, Tex tex, Location at) {
  const gpu::Slot* found = graph_.passes[pass_].pipeline.interface->find(slot);
  const Use use = found && found->kind == gpu::SlotKind::StorageImage ? Use::StorageImageRead : Use::SampledImage;
  return add({slot, tex.id, use, false, {}, at});
}

PassBuilder& PassBuilder::in(const char* slot, Buf buffer, Location at) {
  return add({slot, buffer.id, Use::StorageBufferRead, true, {}, at});
}

PassBuilder& PassBuilder::out(const char* slot, Tex tex, Location at) {
  const bool storage = graph_.passes[pass_].kind == PassKind::Compute;
  return add({slot, tex.id, storage ? Use::StorageImageWrite : Use::ColorAttachment, false, {}, at});
}

PassBuilder& PassBuilder::out(const char* slot, Tex tex, std::array<float, 4> clear, Location at) {
  return add({slot, tex.id, Use::ColorAttachment, false, {true, {clear[0], clear[1], clear[2], clear[3]}}, at});
}

PassBuilder& PassBuilder::inout(const char* slot, Tex tex, Location at) {
  return add({slot, tex.id, Use::StorageImageReadWrite, false, {}, at});
}
PassBuilder& PassBuilder::depth(Tex tex, Location at) {
  return add({nullptr, tex.id, Use::DepthAttachment, false, {}, at});
}
PassBuilder& PassBuilder::depth(Tex tex, float clear, Location at) {
  return add({nullptr, tex.id, Use::DepthAttachment, false, {true, {clear, 0, 0, 0}}, at});
}

PassBuilder& PassBuilder::params_raw(const ParamTable& table, const void* data, Location at) {
  graph_.params.push_back({&table, graph_.add_param_bytes(table, data), at});
  ++graph_.passes[pass_].param_count;
  return *this;
}

PassBuilder& PassBuilder::over(Tex tex) {
  graph_.passes[pass_].over = tex.id;
  return *this;
}

PassBuilder& PassBuilder::set_draw(const DrawCallback& callback) {
  graph_.passes[pass_].draw = callback;
  return *this;
}

uint64_t topology_hash(const Graph& graph) {
  uint64_t hash = 1469598103934665603ull;
  const auto mix = [&](uint64_t value) {
    hash = (hash ^ value) * 0x9E3779B97F4A7C15ull;
    hash ^= hash >> 29;
  };
  const auto mix_text = [&](const char* text) {
    for (; text && *text; ++text) mix(uint8_t(*text));
    mix(0x100);
  };
  for (const ResourceRow& r : graph.resources) {
    mix_text(r.name);
    mix(uint64_t(r.desc.size.width) << 32 | r.desc.size.height);
    mix(uint64_t(r.desc.format) << 32 | uint64_t(r.desc.mips) << 16 | uint64_t(r.desc.layers) << 8 |
        uint64_t(r.lifetime));
  }
  for (const BufferRow& b : graph.buffers) mix_text(b.name);
  for (const PassRow& p : graph.passes) {
    mix_text(p.name);
    mix(uint64_t(p.kind) << 48 | uint64_t(p.pipeline.id.id) << 32 | uint64_t(p.use_count) << 16 | p.param_count);
    mix(p.over);
  }
  for (const UseRow& u : graph.uses) {
    mix_text(u.slot);
    mix(uint64_t(u.resource) << 32 | uint64_t(u.use) << 16 | uint64_t(u.is_buffer) << 8 | uint64_t(u.clear.clear));
    uint64_t bits[2];
    std::memcpy(bits, u.clear.color, sizeof bits);
    mix(bits[0]), mix(bits[1]);
  }
  for (const ParamRow& p : graph.params) mix_text(p.table->prefix);
  for (const ParamRow& p : graph.shared) mix_text(p.table->prefix);
  return hash;
}

}  // namespace nf::graph
