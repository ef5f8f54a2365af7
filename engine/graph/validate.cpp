// Everything that can be wrong with a graph, found before anything runs. Nothing here stops at the first fault.
#include <algorithm>
#include <set>

#include "graph/plan.h"

namespace nf::graph {
namespace {

std::string where(const Location& at) {
  std::string file = at.file;
  for (const char* room : {"/engine/", "/passes/", "/editor/", "/tests/"})
    if (const size_t found = file.rfind(room); found != std::string::npos) file = file.substr(found + 1);
  return fmt::format("{}:{}", file, at.line);
}

bool same_members(const gpu::Slot& slot, const ParamTable& table) {
  return std::equal(slot.members.begin(), slot.members.end(), table.params.begin(), table.params.end(),
                    [](const auto& member, const Param& param) {
                      return member.first == param.name && member.second == param.offset;
                    });
}

class Validator {
 public:
  explicit Validator(const Graph& graph) : graph_(graph) {}

  std::vector<Diagnostic> run() {
    std::vector<bool> written(graph_.resources.size(), false);
    for (size_t r = 0; r < written.size(); ++r) written[r] = graph_.resources[r].lifetime == Lifetime::HistoryPrev;
    for (const PassRow& pass : graph_.passes) {
      pass_ = &pass;
      if (!check_handles()) continue;
      if (pass.kind != PassKind::Readback) check_slots();
      check_sizes();
      check_conflicts();
      check_written(written);
    }
    check_histories(written);
    return std::move(found_);
  }

 private:
  std::span<const UseRow> uses() const { return std::span(graph_.uses).subspan(pass_->first_use, pass_->use_count); }
  const char* resource_name(const UseRow& use) const {
    return use.is_buffer ? graph_.buffers[use.resource].name : graph_.resources[use.resource].name;
  }
  Location declared(const UseRow& use) const {
    return use.is_buffer ? graph_.buffers[use.resource].at : graph_.resources[use.resource].at;
  }
  const char* slot_name(const UseRow& use) const {
    return use.slot ? use.slot : use.use == Use::DepthAttachment ? "(depth)" : "(copy)";
  }

  void report(Diagnostic::Kind kind, const UseRow& use, const std::string& what) {
    found_.push_back(
        {kind, fmt::format("{}: slot '{}', resource '{}': {} (used at {}, declared at {})", pass_->name, slot_name(use),
                           resource_name(use), what, where(use.at), where(declared(use)))});
  }
  void report(Diagnostic::Kind kind, const Location& at, const std::string& what) {
    found_.push_back(
        {kind, fmt::format("{}: {} (at {}, pass declared at {})", pass_->name, what, where(at), where(pass_->at))});
  }

  bool check_handles() {
    bool good = true;
    for (const UseRow& use : uses()) {
      if (use.resource < (use.is_buffer ? graph_.buffers.size() : graph_.resources.size())) continue;
      report(Diagnostic::Kind::StaleHandle, use.at,
             fmt::format("slot '{}' is fed with a handle that is not of this graph", slot_name(use)));
      good = false;
    }
    if (pass_->over != no_resource && pass_->over >= graph_.resources.size()) {
      report(Diagnostic::Kind::StaleHandle, pass_->at, "over() was given a handle that is not of this graph");
      good = false;
    }
    return good;
  }

  void check_slots() {
    const gpu::ShaderInterface& interface = *pass_->pipeline.interface;
    std::set<std::string_view> fed;
    for (const UseRow& use : uses()) {
      if (!use.slot) {
        if (use.use == Use::DepthAttachment && pass_->kind != PassKind::Raster)
          report(Diagnostic::Kind::Direction, use, "only raster passes have a depth attachment");
        continue;
      }
      if (!fed.insert(use.slot).second)
        report(Diagnostic::Kind::UsedTwice, use, "the slot is already fed in this pass");
      if (use.use == Use::ColorAttachment)
        check_color(interface, use);
      else
        check_descriptor(interface, use);
    }
    for (uint32_t i = 0; i < pass_->param_count; ++i)
      check_block(interface, graph_.params[pass_->first_param + i], fed, true);
    for (const ParamRow& row : graph_.shared) check_block(interface, row, fed, false);
    for (const gpu::Slot& slot : interface.slots)
      if (!fed.count(slot.name) && slot.kind != gpu::SlotKind::Sampler)
        report(Diagnostic::Kind::SlotNotFed, pass_->at, fmt::format("the shader's slot '{}' is not fed", slot.name));
    for (const std::string& output : interface.color_outputs)
      if (!fed.count(output))
        report(Diagnostic::Kind::SlotNotFed, pass_->at, fmt::format("the shader's output '{}' is not fed", output));
  }

  void check_color(const gpu::ShaderInterface& interface, const UseRow& use) {
    if (std::find(interface.color_outputs.begin(), interface.color_outputs.end(), use.slot) ==
        interface.color_outputs.end())
      report(Diagnostic::Kind::SlotMissing, use,
             fmt::format("the shader has no such output; it has: {}", fmt::join(interface.color_outputs, ", ")));
  }

  void check_descriptor(const gpu::ShaderInterface& interface, const UseRow& use) {
    const gpu::Slot* slot = interface.find(use.slot);
    if (!slot) {
      std::vector<std::string> names;
      for (const gpu::Slot& s : interface.slots) names.push_back(s.name);
      return report(Diagnostic::Kind::SlotMissing, use,
                    fmt::format("the shader has no such slot; it has: {}", fmt::join(names, ", ")));
    }
    const bool storage =
        use.use == Use::StorageImageRead || use.use == Use::StorageImageWrite || use.use == Use::StorageImageReadWrite;
    const gpu::SlotKind wanted = use.is_buffer ? gpu::SlotKind::StorageBuffer
                                 : storage     ? gpu::SlotKind::StorageImage
                                               : gpu::SlotKind::SampledImage;
    if (slot->kind != wanted)
      return report(Diagnostic::Kind::Direction, use, "the shader declares another kind of descriptor under this name");
    if (use.use == Use::StorageImageRead && slot->writeonly)
      report(Diagnostic::Kind::Direction, use, "fed as an input, but the shader declares it writeonly");
    if (use.use == Use::StorageImageWrite && !slot->writeonly)
      report(Diagnostic::Kind::Direction, use,
             slot->readonly ? "fed as an output, but the shader declares it readonly"
                            : "fed as an output, but the shader also reads it: declare it writeonly or use inout");
    if (use.use == Use::StorageImageReadWrite && (slot->readonly || slot->writeonly))
      report(Diagnostic::Kind::Direction, use, "fed as inout, but the shader declares it readonly or writeonly");
    if (use.is_buffer && !slot->readonly)
      report(Diagnostic::Kind::Direction, use, "fed as an input, but the shader does not declare it readonly");
    if (storage && slot->format != VK_FORMAT_UNDEFINED && slot->format != graph_.resources[use.resource].desc.format)
      report(Diagnostic::Kind::FormatMismatch, use,
             fmt::format("the shader says {}, the image is {}", gpu::format_name(slot->format),
                         gpu::format_name(graph_.resources[use.resource].desc.format)));
  }

  void check_block(const gpu::ShaderInterface& interface, const ParamRow& row, std::set<std::string_view>& fed,
                   bool required) {
    const std::string name = row.table->prefix;
    const gpu::Slot* slot = interface.find(name);
    if (!slot) {
      if (required)
        report(Diagnostic::Kind::SlotMissing, row.at,
               fmt::format("the shader does not use the parameter block '{}'", name));
      return;
    }
    fed.insert(slot->name);
    if (slot->kind != gpu::SlotKind::UniformBlock || slot->block_size != row.table->size)
      report(Diagnostic::Kind::BlockMismatch, row.at,
             fmt::format("block '{}' has {} bytes in the shader, {} in the table", name, slot->block_size,
                         row.table->size));
    else if (!same_members(*slot, *row.table))
      report(Diagnostic::Kind::BlockMismatch, row.at,
             fmt::format("the members of block '{}' stand in another order in the shader than in the table", name));
  }

  void check_sizes() {
    const UseRow* first = nullptr;
    for (const UseRow& use : uses()) {
      if (use.use != Use::ColorAttachment && use.use != Use::DepthAttachment) continue;
      if (!first) first = &use;
      const Size a = graph_.resources[first->resource].desc.size, b = graph_.resources[use.resource].desc.size;
      if (a != b)
        report(Diagnostic::Kind::SizeMismatch, use,
               fmt::format("is {}x{}, but '{}' is {}x{}", b.width, b.height, resource_name(*first), a.width, a.height));
    }
    if (pass_->kind == PassKind::Compute && pass_->over == no_resource)
      report(Diagnostic::Kind::SizeMismatch, pass_->at,
             "no over(): a compute pass must say which image its threads cover");
    if (pass_->over == no_resource) return;
    const Size threads = graph_.resources[pass_->over].desc.size;
    for (const UseRow& use : uses()) {
      if (use.use != Use::StorageImageWrite) continue;
      const Size size = graph_.resources[use.resource].desc.size;
      if (size != threads)
        report(Diagnostic::Kind::SizeMismatch, use,
               fmt::format("is {}x{}, but the threads cover {}x{}", size.width, size.height, threads.width,
                           threads.height));
    }
  }

  void check_conflicts() {
    const auto all = uses();
    for (size_t i = 0; i < all.size(); ++i)
      for (size_t j = 0; j < i; ++j) {
        if (all[i].is_buffer || all[j].is_buffer || all[i].resource != all[j].resource) continue;
        const Access a = access_of(all[i].use, pass_->kind), b = access_of(all[j].use, pass_->kind);
        if (a.layout != b.layout || writes(all[i].use) || writes(all[j].use))
          report(Diagnostic::Kind::UsedTwice, all[i],
                 fmt::format("is already used as {} by slot '{}' of the same pass", b.name, slot_name(all[j])));
      }
  }

  void check_written(std::vector<bool>& written) {
    for (const UseRow& use : uses())
      if (!use.is_buffer && reads(use.use) && !written[use.resource])
        report(Diagnostic::Kind::ReadBeforeWrite, use, "is read before any pass of this frame has written it");
    for (const UseRow& use : uses()) {
      if (use.is_buffer || !writes(use.use)) continue;
      if (graph_.resources[use.resource].lifetime == Lifetime::HistoryPrev)
        report(Diagnostic::Kind::Direction, use,
               "is last frame's image of a history and cannot be written; write next");
      written[use.resource] = true;
    }
  }

  // prev of the next frame is next of this one: somebody must write it.
  void check_histories(const std::vector<bool>& written) {
    for (const PassRow& pass : graph_.passes) {
      pass_ = &pass;
      for (const UseRow& use : uses()) {
        if (use.is_buffer || use.resource >= graph_.resources.size()) continue;
        const ResourceRow& row = graph_.resources[use.resource];
        if (row.lifetime == Lifetime::HistoryPrev && !written[row.pair])
          report(Diagnostic::Kind::ReadBeforeWrite, use,
                 "is read from a history whose next no pass of this frame writes");
      }
    }
  }

  const Graph& graph_;
  const PassRow* pass_ = nullptr;
  std::vector<Diagnostic> found_;
};

}  // namespace

std::vector<Diagnostic> validate(const Graph& graph) {
  return Validator(graph).run();
}

void require_valid(const Graph& graph) {
  const std::vector<Diagnostic> wrong = validate(graph);
  if (wrong.empty()) return;
  std::string text = fmt::format("the frame graph is wrong in {} place{}:", wrong.size(), wrong.size() == 1 ? "" : "s");
  for (const Diagnostic& d : wrong) text += "\n  " + d.text;
  throw Error(Exit::Internal, text);
}

}  // namespace nf::graph
