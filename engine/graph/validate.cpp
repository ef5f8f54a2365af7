// Everything that can be wrong with a graph, found before anything runs. Nothing here stops at the first fault.
#include <algorithm>
#include <map>
#include <set>

#include "graph/phases.h"

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
    for (const ResourceRow& row : graph_.resources)
      written_.emplace_back(cell_count(row), row.lifetime == Lifetime::HistoryPrev ||
                                                 row.lifetime == Lifetime::Imported || row.lifetime == Lifetime::Kept);
    for (const PassRow& pass : graph_.passes) {
      pass_ = &pass;
      if (!check_handles() || !check_parts()) continue;
      if (has_shader(pass_->kind)) check_slots();
      check_lent();
      check_sizes();
      check_conflicts();
      check_written();
    }
    check_history_names();
    check_histories();
    check_read();
    return std::move(found_);
  }

 private:
  std::span<const UseRow> uses() const { return graph_.uses_of(*pass_); }
  const ResourceRow& resource(const UseRow& use) const { return graph_.resources[use.resource]; }
  const char* slot_name(const UseRow& use) const {
    if (use.slot) return use.slot;
    switch (use.use) {
      case Use::DepthAttachment:
        return "(depth)";
      case Use::IndirectArguments:
        return "(indirect)";
      case Use::Indices:
        return "(indices)";
      default:
        return "(copy)";
    }
  }

  void report(Diagnostic::Kind kind, const UseRow& use, const std::string& what) {
    found_.push_back(
        {kind, fmt::format("{}: slot '{}', resource '{}': {} (used at {}, declared at {})", pass_->name, slot_name(use),
                           resource(use).name, what, where(use.at), where(resource(use).at))});
  }
  void report(Diagnostic::Kind kind, const Location& at, const std::string& what) {
    found_.push_back(
        {kind, fmt::format("{}: {} (at {}, pass declared at {})", pass_->name, what, where(at), where(pass_->at))});
  }

  bool check_handles() {
    bool good = true;
    for (const UseRow& use : uses()) {
      if (use.resource < graph_.resources.size()) continue;
      report(Diagnostic::Kind::StaleHandle, use.at,
             fmt::format("slot '{}' is fed with a handle that is not of this graph", slot_name(use)));
      good = false;
    }
    if (pass_->has_over && pass_->over >= graph_.resources.size()) {
      report(Diagnostic::Kind::StaleHandle, pass_->at, "over() was given a handle that is not of this graph");
      good = false;
    }
    return good;
  }

  bool check_parts() {
    bool good = true;
    for (const UseRow& use : uses()) {
      const ResourceRow& row = resource(use);
      if (row.is_buffer ||
          (use.part.mip + use.part.mips <= row.desc.mips && use.part.layer + use.part.layers <= row.desc.layers))
        continue;
      report(Diagnostic::Kind::SizeMismatch, use,
             fmt::format("has {} mips and {} layers, and mips {} to {} of layers {} to {} are used", row.desc.mips,
                         row.desc.layers, use.part.mip, use.part.mip + use.part.mips - 1, use.part.layer,
                         use.part.layer + use.part.layers - 1));
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
        if (use.use == Use::Indices && pass_->kind != PassKind::Raster)
          report(Diagnostic::Kind::Direction, use, "only raster passes have indices");
        if (use.use == Use::IndirectArguments && pass_->kind == PassKind::Fullscreen)
          report(Diagnostic::Kind::Direction, use, "a full-screen pass has no indirect arguments");
        continue;
      }
      if (!fed.insert(use.slot).second)
        report(Diagnostic::Kind::UsedTwice, use, "the slot is already fed in this pass");
      if (use.use == Use::ColorAttachment)
        check_color(interface, use);
      else
        check_descriptor(interface, use);
      check_validity(use);
    }
    for (uint32_t i = 0; i < pass_->param_count; ++i)
      check_block(interface, graph_.params[pass_->first_param + i], fed, true);
    for (const ParamRow& row : graph_.shared) check_block(interface, row, fed, false);
    for (const gpu::Slot& slot : interface.slots)
      if (!fed.count(slot.name) && slot.kind != gpu::SlotKind::Sampler && !slot.unused)
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
    const ResourceRow& row = resource(use);
    const bool storage = use.use != Use::SampledImage;
    const gpu::SlotKind wanted = row.is_buffer ? gpu::SlotKind::StorageBuffer
                                 : storage     ? gpu::SlotKind::StorageImage
                                               : gpu::SlotKind::SampledImage;
    if (slot->kind != wanted)
      return report(Diagnostic::Kind::Direction, use, "the shader declares another kind of descriptor under this name");
    if (storage && reads(use.use) && !writes(use.use)) {
      if (slot->writeonly)
        report(Diagnostic::Kind::Direction, use, "fed as an input, but the shader declares it writeonly");
      else if (!slot->readonly)
        report(Diagnostic::Kind::Direction, use, "fed as an input, but the shader does not declare it readonly");
    }
    if (writes(use.use) && !reads(use.use) && !slot->writeonly)
      report(Diagnostic::Kind::Direction, use,
             slot->readonly ? "fed as an output, but the shader declares it readonly"
                            : "fed as an output, but the shader also reads it: declare it writeonly or use inout");
    if (writes(use.use) && reads(use.use) && (slot->readonly || slot->writeonly))
      report(Diagnostic::Kind::Direction, use, "fed as inout, but the shader declares it readonly or writeonly");
    if (!row.is_buffer) check_shape(*slot, use);
    if (!row.is_buffer && storage && slot->format != VK_FORMAT_UNDEFINED &&
        slot->format != graph_.resources[use.resource].desc.format)
      report(Diagnostic::Kind::FormatMismatch, use,
             fmt::format("the shader says {}, the image is {}", gpu::format_name(slot->format),
                         gpu::format_name(graph_.resources[use.resource].desc.format)));
  }

  void check_shape(const gpu::Slot& slot, const UseRow& use) {
    if (slot.shape == gpu::SlotShape::Flat && use.part.layers != 1)
      report(Diagnostic::Kind::SizeMismatch, use,
             fmt::format("the shader's slot takes one layer, and {} are used: name one with layer()", use.part.layers));
    if (slot.shape == gpu::SlotShape::Cube && use.part.layers != 6)
      report(Diagnostic::Kind::SizeMismatch, use,
             fmt::format("the shader's slot is a cube of 6 layers, and {} are used", use.part.layers));
    if (slot.kind == gpu::SlotKind::StorageImage && use.part.mips != 1)
      report(Diagnostic::Kind::SizeMismatch, use,
             fmt::format("a storage image is one mip, and {} are used: name one with mip()", use.part.mips));
  }

  // An imported image stays in the layout and has the one view it came with.
  void check_lent() {
    for (const UseRow& use : uses()) {
      const gpu::Image* image = resource(use).imported_image;
      if (!image) continue;
      if (use.use != Use::SampledImage && reads(use.use)) {
        report(Diagnostic::Kind::Direction, use, "is an imported image and can only be sampled");
        continue;
      }
      const ImageDesc& desc = resource(use).desc;
      if (use.part != Part{0, desc.mips, 0, desc.layers})
        report(Diagnostic::Kind::SizeMismatch, use, "is an imported image and is sampled as a whole, not in parts");
      const gpu::Slot* slot = use.slot && has_shader(pass_->kind) ? pass_->pipeline.interface->find(use.slot) : nullptr;
      if (!slot || slot->kind != gpu::SlotKind::SampledImage || image->whole == whole_view(slot->shape)) continue;
      const bool layers_fit = slot->shape == gpu::SlotShape::Flat   ? desc.layers == 1
                              : slot->shape == gpu::SlotShape::Cube ? desc.layers == 6
                                                                    : true;
      if (layers_fit)  // else check_shape() has said so
        report(Diagnostic::Kind::SizeMismatch, use,
               "is an imported image whose view (flat, array or cube) is not what the shader's slot takes");
    }
  }
  static gpu::WholeView whole_view(gpu::SlotShape shape) {
    return shape == gpu::SlotShape::Cube    ? gpu::WholeView::Cube
           : shape == gpu::SlotShape::Array ? gpu::WholeView::Array
                                            : gpu::WholeView::Flat;
  }

  // A shader that reads what a frame before has left must be told when there is none.
  void check_validity(const UseRow& use) {
    if (resource(use).lifetime != Lifetime::HistoryPrev) return;
    for (uint32_t i = 0; i < pass_->param_count; ++i)
      if (find_valid_param(*graph_.params[pass_->first_param + i].table, use.slot)) return;
    report(Diagnostic::Kind::ValidityIgnored, use,
           fmt::format("a history is read without its 'valid': a parameter block of the pass needs a Uint or Bool "
                       "'{}_valid', which the graph fills in",
                       use.slot));
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

  Size size_of_use(const UseRow& use) const { return size_of(resource(use).desc, use.part.mip); }

  void check_sizes() {
    const UseRow* first = nullptr;
    for (const UseRow& use : uses()) {
      if (!is_attachment(use.use)) continue;
      if (use.part.mips != 1 || use.part.layers != 1)
        report(Diagnostic::Kind::SizeMismatch, use,
               "an attachment is one mip of one layer: name them with mip(), layer()");
      if (!first) first = &use;
      const Size a = size_of_use(*first), b = size_of_use(use);
      if (a != b)
        report(Diagnostic::Kind::SizeMismatch, use,
               fmt::format("is {}x{}, but '{}' is {}x{}", b.width, b.height, resource(*first).name, a.width, a.height));
    }
    if (pass_->kind == PassKind::Copy) check_copy();
    if (pass_->kind == PassKind::HandOver) check_hand_over();
    if (pass_->kind == PassKind::Compute) check_threads();
  }

  void check_copy() {
    const UseRow &from = uses()[0], &to = uses()[1];
    const ResourceRow &source = resource(from), &target = resource(to);
    if (source.is_buffer) {
      if (source.bytes < target.bytes)
        report(Diagnostic::Kind::SizeMismatch, to,
               fmt::format("takes {} bytes, and '{}' has {}", target.bytes, source.name, source.bytes));
      return;
    }
    const Size a = size_of_use(from), b = size_of_use(to);
    if (a != b || from.part.mips != to.part.mips || from.part.layers != to.part.layers)
      report(
          Diagnostic::Kind::SizeMismatch, to,
          fmt::format("takes {}x{} with {} mips and {} layers, and '{}' has {}x{} with {} and {}", b.width, b.height,
                      to.part.mips, to.part.layers, source.name, a.width, a.height, from.part.mips, from.part.layers));
    if (source.desc.format != target.desc.format)
      report(Diagnostic::Kind::FormatMismatch, to,
             fmt::format("is {}, and '{}' is {}", gpu::format_name(target.desc.format), source.name,
                         gpu::format_name(source.desc.format)));
  }

  void check_hand_over() {
    const UseRow& from = uses()[0];
    const gpu::ImageInfo& to = pass_->target->info;
    const Size size = size_of_use(from);
    if (size.width != to.extent.width || size.height != to.extent.height)
      report(Diagnostic::Kind::SizeMismatch, from,
             fmt::format("is {}x{}, and goes to an image of {}x{}", size.width, size.height, to.extent.width,
                         to.extent.height));
    if (resource(from).desc.format != to.format)
      report(Diagnostic::Kind::FormatMismatch, from,
             fmt::format("is {}, and goes to an image of {}", gpu::format_name(resource(from).desc.format),
                         gpu::format_name(to.format)));
  }

  void check_threads() {
    auto sources = std::count_if(uses().begin(), uses().end(),
                                 [](const UseRow& use) { return use.use == Use::IndirectArguments; });
    sources += (pass_->has_over ? 1 : 0) + (pass_->threads ? 1 : 0);
    if (sources == 0)
      report(Diagnostic::Kind::SizeMismatch, pass_->at,
             "no over(): a compute pass must say which image its threads cover or how many there are, or take their "
             "number with indirect()");
    if (sources > 1)
      report(Diagnostic::Kind::SizeMismatch, pass_->at,
             "more than one over() or indirect(): one of them says how many threads");
    if (!pass_->has_over) return;
    const ImageDesc& desc = graph_.resources[pass_->over].desc;
    if (pass_->over_part.mip >= desc.mips || pass_->over_part.layer + pass_->over_part.layers > desc.layers)
      return report(Diagnostic::Kind::SizeMismatch, pass_->at,
                    "over() names a mip or layer that the image does not have");
    const Size threads = size_of(desc, pass_->over_part.mip);
    for (const UseRow& use : uses()) {
      if (use.use != Use::StorageImageWrite) continue;
      const Size size = size_of_use(use);
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
        if (all[i].resource != all[j].resource || !overlap(all[i].part, all[j].part)) continue;
        const Access a = access_of(all[i].use, pass_->kind), b = access_of(all[j].use, pass_->kind);
        const bool layouts_differ = !resource(all[i]).is_buffer && a.layout != b.layout;
        if (layouts_differ || writes(all[i].use) || writes(all[j].use))
          report(Diagnostic::Kind::UsedTwice, all[i],
                 fmt::format("is already used as {} by slot '{}' of the same pass", b.name, slot_name(all[j])));
      }
  }

  void check_written() {
    for (const UseRow& use : uses()) {
      if (!reads(use.use)) continue;
      bool all = true, any = false;
      for_each_cell(resource(use), use.part, [&](uint32_t c) {
        all &= written_[use.resource][c];
        any |= written_[use.resource][c];
      });
      if (!all)
        report(Diagnostic::Kind::ReadBeforeWrite, use,
               any ? "is read before any pass of this frame has written all the mips and layers read"
                   : "is read before any pass of this frame has written it");
    }
    for (const UseRow& use : uses()) {
      if (!writes(use.use)) continue;
      if (resource(use).lifetime == Lifetime::HistoryPrev)
        report(Diagnostic::Kind::Direction, use, "is last frame's side of a history and cannot be written; write next");
      if (resource(use).lifetime == Lifetime::Imported)
        report(Diagnostic::Kind::Direction, use, "is imported and cannot be written in the frame");
      for_each_cell(resource(use), use.part, [&](uint32_t c) { written_[use.resource][c] = true; });
    }
  }

  void check_history_names() {
    std::map<std::string_view, const ResourceRow*> known;
    for (const ResourceRow& row : graph_.resources) {
      if (row.lifetime != Lifetime::HistoryPrev && row.lifetime != Lifetime::Kept) continue;
      const auto [first, fresh] = known.emplace(row.name, &row);
      if (!fresh)
        found_.push_back(
            {Diagnostic::Kind::UsedTwice,
             fmt::format(
                 "two histories or kept images are named '{}' (declared at {} and at {}): what one frame leaves "
                 "to the next is known by its name",
                 row.name, where(first->second->at), where(row.at))});
    }
  }

  // prev of the next frame is next of this one: somebody must write it.
  void check_histories() {
    for (const PassRow& pass : graph_.passes) {
      pass_ = &pass;
      for (const UseRow& use : uses()) {
        if (use.resource >= graph_.resources.size() || resource(use).lifetime != Lifetime::HistoryPrev) continue;
        bool all = true;
        for_each_cell(resource(use), use.part, [&](uint32_t c) {
          all &= c < written_[resource(use).pair].size() && written_[resource(use).pair][c];
        });
        if (!all)
          report(Diagnostic::Kind::ReadBeforeWrite, use,
                 "is read from a history whose next no pass of this frame writes");
      }
    }
  }

  // Whoever writes something wants it read. Reported once, at the first write.
  void check_read() {
    std::vector<bool> is_read(graph_.resources.size(), false);
    for (const UseRow& use : graph_.uses)
      if (use.resource < is_read.size() && (reads(use.use) || use.use == Use::DepthAttachment)) {
        is_read[use.resource] = true;
        if (resource(use).lifetime == Lifetime::HistoryPrev) is_read[resource(use).pair] = true;
      }
    for (const PassRow& pass : graph_.passes) {
      pass_ = &pass;
      for (const UseRow& use : uses()) {
        if (use.resource >= is_read.size() || is_read[use.resource] || resource(use).optional || !writes(use.use))
          continue;
        is_read[use.resource] = true;
        report(Diagnostic::Kind::WrittenNeverRead, use,
               "is written and never read: read it, or call graph.optional() with it if it is a by-product");
      }
    }
  }

  const Graph& graph_;
  const PassRow* pass_ = nullptr;
  std::vector<std::vector<bool>> written_;  // by resource and cell, so far
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
