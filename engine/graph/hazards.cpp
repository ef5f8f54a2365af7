// The replay.
#include "graph/hazards.h"

#include <algorithm>

namespace nf::graph {
namespace {

// Beside passes: whose content a cell holds.
constexpr int nobody = -1, garbage = -2, settled = -3;

struct Past {
  VkPipelineStageFlags2 stages = 0;   // where it happens; none for a layout transition
  VkPipelineStageFlags2 ordered = 0;  // where what follows is known to come after it
};

template <class F>
void for_each_bit(uint64_t mask, F&& f) {
  for (; mask; mask &= mask - 1) f(mask & (~mask + 1));
}

struct CellState {
  bool has_write = false, available = false;
  bool begun = false;  // in this frame: a barrier has taken the bytes over
  Past write;
  VkAccessFlags2 write_access = 0;
  std::vector<std::pair<VkPipelineStageFlags2, VkAccessFlags2>> visible;  // by single stage
  std::vector<Past> reads;                                                // since the write
  VkImageLayout layout = VK_IMAGE_LAYOUT_UNDEFINED;
  int content = garbage;

  void make_visible(VkPipelineStageFlags2 stages, VkAccessFlags2 access) {
    for_each_bit(stages, [&](uint64_t stage) {
      for (auto& [known, accesses] : visible)
        if (known == stage) {
          accesses |= access;
          return;
        }
      visible.emplace_back(stage, access);
    });
  }
  bool is_visible(VkPipelineStageFlags2 stages, VkAccessFlags2 access) const {
    bool all = true;
    for_each_bit(stages, [&](uint64_t stage) {
      VkAccessFlags2 known = 0;
      for (const auto& [at, accesses] : visible)
        if (at == stage) known = accesses;
      all &= !(access & ~known);
    });
    return all;
  }
};

// What a use needs, from the specification rather than from the engine's table.
struct Need {
  VkPipelineStageFlags2 stages;
  VkAccessFlags2 read, write;
  VkImageLayout layout;
};

Need need_of(const Plan& plan, const PassRow& pass, const UseRow& use, size_t row) {
  VkPipelineStageFlags2 shader = VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT;
  if (pass.kind == PassKind::Compute) shader = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;
  if (pass.kind == PassKind::Raster) shader |= VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT;
  const bool loads = plan.uses[row].load == VK_ATTACHMENT_LOAD_OP_LOAD;
  const auto layout = [&](VkImageLayout exact) {
    return plan.layouts == LayoutPolicy::General ? VK_IMAGE_LAYOUT_GENERAL : exact;
  };
  switch (use.use) {
    case Use::SampledImage:
      return {shader, VK_ACCESS_2_SHADER_SAMPLED_READ_BIT, 0, layout(VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL)};
    case Use::StorageImageRead:
    case Use::StorageBufferRead:
      return {shader, VK_ACCESS_2_SHADER_STORAGE_READ_BIT, 0, VK_IMAGE_LAYOUT_GENERAL};
    case Use::StorageImageWrite:
    case Use::StorageBufferWrite:
      return {shader, 0, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT, VK_IMAGE_LAYOUT_GENERAL};
    case Use::StorageImageReadWrite:
    case Use::StorageBufferReadWrite:
      return {shader, VK_ACCESS_2_SHADER_STORAGE_READ_BIT, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT,
              VK_IMAGE_LAYOUT_GENERAL};
    case Use::ColorAttachment:
      return {VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT,
              loads ? VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT : VkAccessFlags2(0), VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT,
              layout(VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL)};
    case Use::DepthAttachment:
      return {VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT,
              VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT, VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT,
              layout(VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL)};
    case Use::CopySource:
      return {VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_READ_BIT, 0,
              layout(VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL)};
    case Use::CopyDestination:
      return {VK_PIPELINE_STAGE_2_COPY_BIT, 0, VK_ACCESS_2_TRANSFER_WRITE_BIT,
              layout(VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL)};
    case Use::IndirectArguments:
      return {VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT, VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT, 0, {}};
    case Use::Indices:
      return {VK_PIPELINE_STAGE_2_INDEX_INPUT_BIT, VK_ACCESS_2_INDEX_READ_BIT, 0, {}};
  }
  return {};
}

class Replay {
 public:
  Replay(const Graph& graph, const Plan& plan, size_t limit) : graph_(graph), plan_(plan), limit_(limit) {
    for (const ResourceRow& row : graph.resources) states_.emplace_back(cell_count(row));
    find_expected();
    cut_heaps();
  }

  std::vector<std::string> run() {
    settle();
    // A transient meets itself in the second frame, a history's image in the third.
    const bool histories = std::any_of(graph_.resources.begin(), graph_.resources.end(),
                                       [](const ResourceRow& row) { return row.lifetime == Lifetime::HistoryPrev; });
    for (frame_ = 0; frame_ < (histories ? 3 : 2) && found_.size() < limit_; ++frame_) {
      for (size_t r = 0; r < states_.size(); ++r)
        if (graph_.resources[r].lifetime == Lifetime::Transient)
          for (CellState& cell : states_[r]) cell.begun = false;
      for (const PlannedPass& planned : plan_.passes) {
        const PassRow& pass = graph_.passes[planned.pass];
        pass_ = pass.name;
        for (uint32_t b = planned.first_barrier; b < planned.first_barrier + planned.barrier_count; ++b)
          apply(plan_.barriers[b]);
        for (uint32_t u = pass.first_use; u < pass.first_use + pass.use_count; ++u) check(pass, u, int(planned.pass));
      }
      check_handed_on();
    }
    if (found_.size() > limit_) found_.resize(limit_);
    return std::move(found_);
  }

 private:
  struct Segment {
    uint64_t begin, end;
    int owner = nobody, owner_before = nobody;  // resources
  };

  template <class F>
  void for_cells(uint16_t resource, const Part& part, F&& f) {
    const uint32_t mips = graph_.resources[resource].desc.mips;
    for (uint32_t layer = part.layer; layer < uint32_t(part.layer + part.layers); ++layer)
      for (uint32_t mip = part.mip; mip < uint32_t(part.mip + part.mips); ++mip)
        f(graph_.resources[resource].is_buffer ? 0 : layer * mips + mip);
  }

  void object(uint16_t resource, const std::string& what) {
    if (found_.size() <= limit_)
      found_.push_back(
          fmt::format("frame {}, pass {}, resource '{}': {}", frame_, pass_, graph_.resources[resource].name, what));
  }

  // Whose content each cell of each use must hold: what the declared order means, culled passes included.
  void find_expected() {
    std::vector<std::vector<int>> writer;
    for (const ResourceRow& row : graph_.resources) writer.emplace_back(cell_count(row), nobody);
    expected_.resize(graph_.uses.size());
    for (size_t p = 0; p < graph_.passes.size(); ++p) {
      const PassRow& pass = graph_.passes[p];
      for (uint32_t u = pass.first_use; u < pass.first_use + pass.use_count; ++u) {
        const UseRow& use = graph_.uses[u];
        for_cells(use.resource, use.part, [&](uint32_t c) { expected_[u].push_back(writer[use.resource][c]); });
      }
      for (const UseRow& use : graph_.uses_of(pass))
        if (writes(use.use)) for_cells(use.resource, use.part, [&](uint32_t c) { writer[use.resource][c] = int(p); });
    }
    last_writer_ = std::move(writer);
  }

  // The heaps' bytes, cut wherever a resource begins or ends.
  void cut_heaps() {
    segments_.resize(plan_.heaps.size());
    for (size_t h = 0; h < plan_.heaps.size(); ++h) {
      std::vector<uint64_t> cuts;
      for (const PlannedResource& planned : plan_.resources)
        if (planned.live && planned.heap == int(h)) {
          cuts.push_back(planned.offset);
          cuts.push_back(planned.offset + planned.bytes);
        }
      std::sort(cuts.begin(), cuts.end());
      cuts.erase(std::unique(cuts.begin(), cuts.end()), cuts.end());
      for (size_t i = 1; i < cuts.size(); ++i) segments_[h].push_back({cuts[i - 1], cuts[i]});
    }
  }
  std::span<Segment> segments_of(uint16_t resource) {
    const PlannedResource& planned = plan_.resources[resource];
    if (planned.heap < 0) return {};
    std::vector<Segment>& all = segments_[size_t(planned.heap)];
    const auto before = [](const Segment& s, uint64_t at) { return s.begin < at; };
    const auto first = std::lower_bound(all.begin(), all.end(), planned.offset, before);
    const auto last = std::lower_bound(all.begin(), all.end(), planned.offset + planned.bytes, before);
    return {first, last};
  }

  // A history's two images change places every frame.
  std::vector<CellState>& states(uint16_t resource) {
    const ResourceRow& row = graph_.resources[resource];
    if (row.pair == no_resource || frame_ % 2 == 0) return states_[resource];
    return states_[row.pair];
  }

  // The executor's promise for the first frame of a plan: everything earlier is finished, and prev has content and the
  // layout in which the ring leaves it.
  void settle() {
    std::vector<std::vector<VkImageLayout>> last;
    for (const ResourceRow& row : graph_.resources) last.emplace_back(cell_count(row), VK_IMAGE_LAYOUT_UNDEFINED);
    for (const PlannedPass& planned : plan_.passes) {
      const PassRow& pass = graph_.passes[planned.pass];
      for (uint32_t u = pass.first_use; u < pass.first_use + pass.use_count; ++u) {
        const UseRow& use = graph_.uses[u];
        for_cells(use.resource, use.part,
                  [&](uint32_t c) { last[use.resource][c] = need_of(plan_, pass, use, u).layout; });
      }
    }
    for (size_t r = 0; r < states_.size(); ++r) {
      const ResourceRow& row = graph_.resources[r];
      if (row.lifetime != Lifetime::HistoryPrev && row.lifetime != Lifetime::Kept) continue;
      const std::vector<VkImageLayout>& left = last[row.pair == no_resource ? r : row.pair];
      for (size_t c = 0; c < states_[r].size(); ++c) {
        states_[r][c].content = settled;
        states_[r][c].layout = left[c] != VK_IMAGE_LAYOUT_UNDEFINED ? left[c] : last[r][c];
      }
    }
  }

  static bool in_scope(const Past& past, VkPipelineStageFlags2 src) {
    return (past.stages && !(past.stages & ~src)) || (past.ordered & src);
  }

  // The bytes change hands: everything the owner before did there must be in the barrier's scope.
  void take_over(const Barrier& b) {
    for (const Segment& s : segments_of(b.resource)) {
      if (s.owner_before == nobody || s.owner_before == int(b.resource)) continue;
      for (const CellState& other : states_[size_t(s.owner_before)]) {
        for (const Past& read : other.reads)
          if (!in_scope(read, b.src_stages))
            object(b.resource, fmt::format("takes bytes of '{}' without waiting for a read of it",
                                           graph_.resources[size_t(s.owner_before)].name));
        if (!other.has_write) continue;
        if (!in_scope(other.write, b.src_stages) || (!other.available && (other.write_access & ~b.src_access)))
          object(b.resource, fmt::format("takes bytes of '{}' without waiting for a write of it",
                                         graph_.resources[size_t(s.owner_before)].name));
      }
    }
  }

  void apply(const Barrier& b) {
    const ResourceRow& row = graph_.resources[b.resource];
    if (row.lifetime == Lifetime::Imported) return object(b.resource, "a barrier for what is only read");
    const bool transient = row.lifetime == Lifetime::Transient;
    for_cells(b.resource, b.part, [&](uint32_t index) {
      CellState& cell = states(b.resource)[index];
      bool taken = false;  // from somebody else
      if (transient && !cell.begun) {
        cell.begun = true;
        if (!row.is_buffer && b.old_layout != VK_IMAGE_LAYOUT_UNDEFINED)
          object(b.resource, "its first barrier of the frame keeps content that is not its own");
        taken = begin(b, cell);
      }
      apply_to(b, row, cell, taken);
    });
  }

  // The first barrier of a transient's cell in a frame. Whether another resource had all its bytes in between.
  bool begin(const Barrier& b, CellState& cell) {
    bool own = false, other = false;
    for (Segment& s : segments_of(b.resource)) {
      if (s.owner != int(b.resource)) s.owner_before = s.owner, s.owner = int(b.resource);
      own |= s.owner_before == nobody || s.owner_before == int(b.resource);
      other |= s.owner_before != nobody && s.owner_before != int(b.resource);
    }
    take_over(b);
    // Its own past is behind whoever came in between.
    if (other && !own) cell = CellState{.begun = true};
    return other;
  }

  void apply_to(const Barrier& b, const ResourceRow& row, CellState& cell, bool taken) {
    const bool discards = b.old_layout == VK_IMAGE_LAYOUT_UNDEFINED;
    const bool transition = !row.is_buffer && (discards || b.old_layout != b.new_layout);
    if (!row.is_buffer && !discards && b.old_layout != cell.layout)
      object(b.resource, "a barrier from a layout the image is not in");
    const bool rewritten = transition || taken;
    for (Past& read : cell.reads) {
      if (in_scope(read, b.src_stages))
        read.ordered |= b.dst_stages;
      else if (rewritten)
        object(b.resource, "a barrier discards or moves what is still being read");
    }
    const bool ordered = cell.has_write && in_scope(cell.write, b.src_stages);
    if (ordered) {
      cell.write.ordered |= b.dst_stages;
      cell.available |= !(cell.write_access & ~b.src_access);
      if (cell.available) cell.make_visible(b.dst_stages, b.dst_access);
    }
    if (!rewritten) return;
    if (cell.has_write && !(ordered && cell.available))
      object(b.resource, "a barrier discards or moves what is still being written");
    // A transition is a write; so is, for what comes after, what others did to the bytes.
    cell.reads.clear();
    cell.has_write = cell.available = true;
    cell.write = {0, b.dst_stages};
    cell.write_access = 0;
    cell.visible.clear();
    cell.make_visible(b.dst_stages, b.dst_access);
    if (row.is_buffer || discards) cell.content = garbage;
    cell.layout = b.new_layout;
  }

  void check(const PassRow& pass, uint32_t row_of_use, int pass_row) {
    const UseRow& use = graph_.uses[row_of_use];
    const ResourceRow& row = graph_.resources[use.resource];
    if (row.lifetime == Lifetime::Imported) {
      if (writes(use.use)) object(use.resource, "is written, but only lent to the frame");
      if (!row.is_buffer && use.use != Use::SampledImage)
        object(use.resource, "is lent to be sampled, and is used in another layout");
      return;
    }
    for (const Segment& s : segments_of(use.resource))
      if (s.owner != int(use.resource)) {
        object(use.resource, s.owner == nobody ? "is used before a barrier has taken its bytes"
                                               : fmt::format("is used after '{}' took its bytes",
                                                             graph_.resources[size_t(s.owner)].name));
        break;
      }
    const Need need = need_of(plan_, pass, use, row_of_use);
    size_t i = 0;
    for_cells(use.resource, use.part, [&](uint32_t c) {
      int expected = expected_[row_of_use][i++];
      if (row.lifetime == Lifetime::HistoryPrev) expected = frame_ > 0 ? last_writer_[row.pair][c] : settled;
      if (row.lifetime == Lifetime::Kept && expected == nobody) {
        const int before = frame_ > 0 ? last_writer_[use.resource][c] : nobody;
        expected = before == nobody ? settled : before;
      }
      if (row.lifetime == Lifetime::Transient && !states(use.resource)[c].begun)
        object(use.resource, "is used without a barrier in this frame");
      check_cell(use, need, plan_.uses[row_of_use], expected, pass_row, states(use.resource)[c]);
    });
  }

  // Whoever reads a history in the next frame, by this graph or by another, gets all that this one declares.
  void check_handed_on() {
    for (uint16_t r = 0; r < states_.size(); ++r)
      if (const Lifetime lifetime = graph_.resources[r].lifetime;
          (lifetime == Lifetime::HistoryNext || lifetime == Lifetime::Kept) && plan_.resources[r].live)
        for (size_t c = 0; c < last_writer_[r].size(); ++c)
          if (last_writer_[r][c] != nobody && states(r)[c].content != last_writer_[r][c])
            object(r, "is not kept for the next frame");
  }

  void check_cell(const UseRow& use, const Need& need, const PlannedUse& planned, int expected, int pass_row,
                  CellState& cell) {
    if (!graph_.resources[use.resource].is_buffer && cell.layout != need.layout)
      object(use.resource, "is in another layout");
    if (cell.has_write) {
      if (need.stages & ~cell.write.ordered) object(use.resource, "is not ordered after its last write");
      if (!cell.is_visible(need.stages, need.read | need.write)) object(use.resource, "its last write is not visible");
    }
    const bool attachment = is_attachment(use.use);
    const bool reads_content = attachment ? planned.load == VK_ATTACHMENT_LOAD_OP_LOAD : need.read != 0;
    // An attachment that nobody wants may load what culling took away; what it then holds is worth nothing.
    const bool stale = reads_content && cell.content != expected;
    if (stale && !attachment)
      object(use.resource, fmt::format("holds content of {}, not of {}", author(cell.content), author(expected)));
    const bool lost = attachment && !use.clear.clear && !reads_content && cell.content >= 0;
    if (lost && use.use == Use::DepthAttachment) object(use.resource, "is tested against depth that was not loaded");
    if (!need.write) {
      cell.reads.push_back({need.stages, 0});
      return;
    }
    for (const Past& read : cell.reads)
      if (need.stages & ~read.ordered) object(use.resource, "is written before a read of it is done");
    cell.reads.clear();
    cell.has_write = true;
    cell.available = false;
    cell.write = {need.stages, 0};
    cell.write_access = need.write;
    cell.visible.clear();
    const bool kept = !attachment || planned.store == VK_ATTACHMENT_STORE_OP_STORE;
    cell.content = stale || lost || !kept ? garbage : pass_row;
  }

  std::string author(int content) const {
    if (content >= 0) return graph_.passes[size_t(content)].name;
    return content == settled ? "the frame before" : "nobody";
  }

  const Graph& graph_;
  const Plan& plan_;
  size_t limit_;
  std::vector<std::vector<CellState>> states_;  // by resource and cell
  std::vector<std::vector<Segment>> segments_;  // by heap
  std::vector<std::vector<int>> expected_;      // by use and cell of its part
  std::vector<std::vector<int>> last_writer_;   // by resource and cell
  int frame_ = 0;
  const char* pass_ = "";
  std::vector<std::string> found_;
};

}  // namespace

std::vector<std::string> find_hazards(const Graph& graph, const Plan& plan, size_t limit) {
  return Replay(graph, plan, limit).run();
}

}  // namespace nf::graph
