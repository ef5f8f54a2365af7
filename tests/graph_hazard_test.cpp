// Barriers of random graphs, replayed by an independent and dumber model of Vulkan's rules: per physical image the last
// write, the reads since, the stages that are ordered after each, what has been made available and to which stage it is
// visible, the layout, and whose content is in it. It looks at each image alone, so it is stricter than Vulkan, where
// one image's barrier also orders another's uses. Then every barrier is removed and weakened, and the replay must
// object.
#include <deque>
#include <gtest/gtest.h>
#include <map>
#include <random>
#include <set>

#include "graph_values.h"

namespace nf::graph {
namespace {

constexpr int frames = 4;                                  // the ring through a history closes after two
constexpr int no_writer = -1, garbage = -2, settled = -3;  // beside passes: whose content an image holds

struct Past {
  VkPipelineStageFlags2 stages = 0;   // where it happens; none for a layout transition
  VkPipelineStageFlags2 ordered = 0;  // where what follows is known to come after it
};

struct PhysicalImage {
  bool has_write = false, available = false;
  Past write;
  VkAccessFlags2 write_access = 0;
  std::map<VkPipelineStageFlags2, VkAccessFlags2> visible;  // by single stage
  std::vector<Past> reads;                                  // since the write
  VkImageLayout layout = VK_IMAGE_LAYOUT_UNDEFINED;
  int content = garbage;
};

// What a use needs, from the specification rather than from the engine's table.
struct Need {
  VkPipelineStageFlags2 stage;
  VkAccessFlags2 read, write;
  VkImageLayout layout;
};
Need need_of(const Plan& plan, const PassRow& pass, const UseRow& use, size_t row) {
  const VkPipelineStageFlags2 shader = pass.kind == PassKind::Compute ? compute_stage : fragment_stage;
  switch (use.use) {
    case Use::SampledImage:
      return {shader, sampled_read, 0, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
    case Use::StorageImageRead:
      return {shader, storage_read, 0, VK_IMAGE_LAYOUT_GENERAL};
    case Use::StorageImageWrite:
      return {shader, 0, storage_write, VK_IMAGE_LAYOUT_GENERAL};
    case Use::StorageImageReadWrite:
      return {shader, storage_read, storage_write, VK_IMAGE_LAYOUT_GENERAL};
    case Use::CopySource:
      return {copy_stage, VK_ACCESS_2_TRANSFER_READ_BIT, 0, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL};
    default:
      break;
  }
  const bool loads = plan.uses[row].load == VK_ATTACHMENT_LOAD_OP_LOAD;
  return {color_stage, loads ? VkAccessFlags2(VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT) : 0,
          VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
}

template <class F>
void for_each_bit(uint64_t mask, F&& f) {
  for (; mask; mask &= mask - 1) f(mask & (~mask + 1));
}

class Replay {
 public:
  Replay(const Graph& graph, const Plan& plan) : graph_(graph), plan_(plan) {}

  // The first objection; empty when there is none. `dropped` is left out.
  std::string run(int dropped = -1) {
    images_.assign(graph_.resources.size(), {});
    settle();
    for (frame_ = 0; frame_ < frames && objection_.empty(); ++frame_) {
      std::vector<int> writer(graph_.resources.size(), no_writer);
      size_t next = 0;
      for (size_t row = 0; row < graph_.passes.size(); ++row) {
        const PassRow& pass = graph_.passes[row];
        pass_ = pass.name;
        if (next < plan_.passes.size() && plan_.passes[next].pass == row) {
          const PlannedPass& planned = plan_.passes[next++];
          for (uint32_t b = planned.first_barrier; b < planned.first_barrier + planned.barrier_count; ++b)
            if (int(b) != dropped) apply(plan_.barriers[b]);
          for (uint32_t u = pass.first_use; u < pass.first_use + pass.use_count; ++u)
            check(pass, graph_.uses[u], u, int(row), writer);
        }
        // Culled or not: this is what the declared order means.
        for (uint32_t u = pass.first_use; u < pass.first_use + pass.use_count; ++u)
          if (writes(graph_.uses[u].use)) writer[graph_.uses[u].resource] = int(row);
      }
      last_writer_ = writer;
    }
    return objection_;
  }

 private:
  void object(const std::string& what) {
    if (objection_.empty()) objection_ = fmt::format("frame {}, pass {}: {}", frame_, pass_, what);
  }
  // A history's two images change places every frame.
  PhysicalImage& image(uint16_t resource) {
    const ResourceRow& row = graph_.resources[resource];
    if (row.lifetime == Lifetime::Transient || frame_ % 2 == 0) return images_[resource];
    return images_[row.pair];
  }
  // The executor's promise for the first frame of a plan: histories have content and the layout in which the ring
  // leaves them.
  void settle() {
    frame_ = 0;
    std::vector<VkImageLayout> last(images_.size(), VK_IMAGE_LAYOUT_UNDEFINED);
    for (const PlannedPass& planned : plan_.passes) {
      const PassRow& pass = graph_.passes[planned.pass];
      for (uint32_t u = pass.first_use; u < pass.first_use + pass.use_count; ++u)
        last[graph_.uses[u].resource] = need_of(plan_, pass, graph_.uses[u], u).layout;
    }
    for (size_t r = 0; r < images_.size(); ++r) {
      const ResourceRow& row = graph_.resources[r];
      if (row.lifetime != Lifetime::HistoryPrev) continue;
      images_[r].content = settled;
      images_[r].layout = last[row.pair] != VK_IMAGE_LAYOUT_UNDEFINED ? last[row.pair] : last[r];
    }
  }

  static bool in_scope(const Past& past, VkPipelineStageFlags2 src) {
    return (past.stages && !(past.stages & ~src)) || (past.ordered & src);
  }

  void apply(const Barrier& b) {
    PhysicalImage& im = image(b.resource);
    const bool transition = b.old_layout == VK_IMAGE_LAYOUT_UNDEFINED || b.old_layout != b.new_layout;
    if (b.old_layout != VK_IMAGE_LAYOUT_UNDEFINED && b.old_layout != im.layout)
      object("a barrier from a layout the image is not in");
    for (Past& read : im.reads) {
      if (in_scope(read, b.src_stages))
        read.ordered |= b.dst_stages;
      else if (transition)
        object("a layout transition that does not wait for a read");
    }
    const bool ordered = im.has_write && in_scope(im.write, b.src_stages);
    if (ordered) {
      im.write.ordered |= b.dst_stages;
      im.available |= !(im.write_access & ~b.src_access);
      if (im.available) for_each_bit(b.dst_stages, [&](uint64_t stage) { im.visible[stage] |= b.dst_access; });
    }
    if (!transition) return;
    if (im.has_write && !(ordered && im.available)) object("a layout transition that overtakes a write");
    im.reads.clear();
    im.has_write = im.available = true;
    im.write = {0, b.dst_stages};
    im.write_access = 0;
    im.visible.clear();
    for_each_bit(b.dst_stages, [&](uint64_t stage) { im.visible[stage] = b.dst_access; });
    im.layout = b.new_layout;
    if (b.old_layout == VK_IMAGE_LAYOUT_UNDEFINED) im.content = garbage;
  }

  void check(const PassRow& pass, const UseRow& use, size_t row, int pass_row, const std::vector<int>& writer) {
    PhysicalImage& im = image(use.resource);
    const Need need = need_of(plan_, pass, use, row);
    const char* name = graph_.resources[use.resource].name;
    if (im.layout != need.layout) object(fmt::format("{} is in another layout", name));
    if (im.has_write) {
      if (need.stage & ~im.write.ordered) object(fmt::format("{} is not ordered after its write", name));
      if ((need.read | need.write) & ~im.visible[need.stage]) object(fmt::format("{}'s write is not visible", name));
    }
    const bool prev = graph_.resources[use.resource].lifetime == Lifetime::HistoryPrev;
    const int wanted = !prev        ? writer[use.resource]
                       : frame_ > 0 ? last_writer_[graph_.resources[use.resource].pair]
                                    : settled;
    // An attachment that nobody wants may load what culling took away; what it then holds is worth nothing.
    const bool stale = need.read && im.content != wanted;
    if (stale && use.use != Use::ColorAttachment)
      object(fmt::format("{} has content of {}, not of {}", name, im.content, wanted));
    if (!need.write) {
      im.reads.push_back({need.stage, 0});
      return;
    }
    for (const Past& read : im.reads)
      if (need.stage & ~read.ordered) object(fmt::format("{} is written before it is read", name));
    im.reads.clear();
    im.has_write = true;
    im.available = false;
    im.write = {need.stage, 0};
    im.write_access = need.write;
    im.visible.clear();
    im.content = stale ? garbage : pass_row;
  }

  const Graph& graph_;
  const Plan& plan_;
  std::vector<PhysicalImage> images_;
  std::vector<int> last_writer_;
  int frame_ = 0;
  const char* pass_ = "";
  std::string objection_;
};

// A valid graph: 3-20 compute and full-screen passes over 3-15 images, up to three of them histories.
class RandomGraph {
 public:
  explicit RandomGraph(uint32_t seed) : random_(seed) {
    const ImageDesc desc{{64, 64}, VK_FORMAT_R32_SFLOAT};
    const int images = pick(3, 15), histories = pick(0, std::min(3, images / 2));
    for (int i = 0; i < images - 2 * histories; ++i) targets_.push_back(graph.image(name("image", i), desc));
    for (int i = 0; i < histories; ++i) {
      const History h = graph.history(name("history", i), desc);
      targets_.push_back(h.next);
      readable_.push_back(h.prev);
      unwritten_.push_back(h.next);
    }
    const int passes = pick(3, 20);
    for (int i = 0; i < passes; ++i) {
      if (i > 0 && pick(0, 7) == 0) add_readback();
      add_pass(name("pass", i), {});
    }
    // A history that is read must be written by somebody.
    while (!unwritten_.empty()) add_pass(name("last", int(unwritten_.size())), unwritten_.back());
    for (int i = pick(1, 3); i > 0; --i) add_readback();
  }
  Graph graph;

 private:
  int pick(int low, int high) { return std::uniform_int_distribution(low, high)(random_); }
  const char* name(const char* kind, int i) { return names_.emplace_back(fmt::format("{}{}", kind, i)).c_str(); }
  template <class T>
  T any(const std::vector<T>& of) {
    return of[size_t(pick(0, int(of.size()) - 1))];
  }
  void add_readback() {
    if (!readable_.empty()) graph.readback("readback", any(readable_));
  }

  void add_pass(const char* pass_name, Tex target) {
    const bool compute = pick(0, 2) > 0;
    std::set<uint16_t> used;
    std::vector<gpu::Slot> slots;
    std::vector<std::string> outputs;
    std::vector<Tex> in, out, inout;
    const auto fresh = [&](Tex tex) { return used.insert(tex.id).second; };
    for (int i = target ? 1 : pick(1, 2); i > 0; --i)
      if (const Tex tex = target ? target : any(targets_); fresh(tex)) out.push_back(tex);
    for (int i = readable_.empty() ? 0 : pick(0, 4); i > 0; --i) {
      const Tex tex = any(readable_);
      const bool writable = graph.resources[tex.id].lifetime != Lifetime::HistoryPrev;
      if (fresh(tex)) (compute && writable && pick(0, 5) == 0 ? inout : in).push_back(tex);
    }
    for (size_t i = 0; i < in.size(); ++i)
      slots.push_back(pick(0, 1) ? sampled(fmt::format("in{}", i)) : storage_in(fmt::format("in{}", i)));
    for (size_t i = 0; i < inout.size(); ++i) slots.push_back(storage_inout(fmt::format("inout{}", i)));
    for (size_t i = 0; i < out.size(); ++i)
      compute ? slots.push_back(storage_out(fmt::format("out{}", i))) : outputs.push_back(fmt::format("out{}", i));

    const gpu::Pipeline pipeline = shaders_.make(slots, outputs);
    PassBuilder pass = compute ? graph.compute(pass_name, pipeline) : graph.fullscreen(pass_name, pipeline);
    for (size_t i = 0; i < in.size(); ++i) pass.in(name("in", int(i)), in[i]);
    for (size_t i = 0; i < inout.size(); ++i) pass.inout(name("inout", int(i)), inout[i]);
    for (size_t i = 0; i < out.size(); ++i) {
      if (!compute && pick(0, 2) == 0)
        pass.out(name("out", int(i)), out[i], {0, 0, 0, 0});
      else
        pass.out(name("out", int(i)), out[i]);
      std::erase(unwritten_, out[i]);
      if (std::find(readable_.begin(), readable_.end(), out[i]) == readable_.end()) readable_.push_back(out[i]);
    }
    if (compute) pass.over(out[0]);
  }

  std::mt19937 random_;
  Shaders shaders_;
  std::deque<std::string> names_;
  std::vector<Tex> targets_, readable_, unwritten_;
};

// Counts of a kind of mutation, and the first few that nobody noticed.
struct Mutations {
  size_t tried = 0, killed = 0;
  std::vector<std::string> survivors;
  void add(const std::string& objection, const std::string& what) {
    ++tried;
    if (!objection.empty())
      ++killed;
    else if (survivors.size() < 5)
      survivors.push_back(what);
  }
  void expect_all(const char* kind) const {
    fmt::print("{}: {} of {} noticed ({:.2f} %)\n", kind, killed, tried, 100 * double(killed) / double(tried));
    EXPECT_GT(tried, 1000u);
    EXPECT_EQ(killed, tried) << kind << ", survivors:\n" << fmt::format("{}", fmt::join(survivors, "\n"));
  }
};

std::string describe(const Graph& graph, const Plan& plan, uint32_t seed, size_t barrier) {
  const Barrier& b = plan.barriers[barrier];
  std::string pass;
  for (const PlannedPass& p : plan.passes)
    if (barrier >= p.first_barrier && barrier < p.first_barrier + p.barrier_count) pass = graph.passes[p.pass].name;
  return fmt::format(
      "seed {}: barrier {} of {}{} before {}: stages {:#x} -> {:#x}, access {:#x} -> {:#x}, layout {} -> {}", seed,
      barrier, graph.resources[b.resource].name,
      graph.resources[b.resource].lifetime == Lifetime::HistoryPrev ? ".prev" : "", pass, b.src_stages, b.dst_stages,
      b.src_access, b.dst_access, int(b.old_layout), int(b.new_layout));
}

constexpr uint32_t graphs = 300;

TEST(GraphHazardTest, RandomGraphsAreFreeOfHazards) {
  size_t passes = 0, culled = 0, barriers = 0;
  for (uint32_t seed = 1; seed <= graphs; ++seed) {
    const RandomGraph random(seed);
    for (const Diagnostic& d : validate(random.graph)) ADD_FAILURE() << "seed " << seed << ": " << d.text;
    const Plan plan = compile(random.graph, {.alias = false});
    EXPECT_EQ(Replay(random.graph, plan).run(), "") << "seed " << seed;
    passes += plan.passes.size();
    culled += random.graph.passes.size() - plan.passes.size();
    barriers += plan.barriers.size();
  }
  fmt::print("{} graphs: {} passes, {} culled, {} barriers\n", graphs, passes, culled, barriers);
  EXPECT_GT(culled, graphs / 2);
}

TEST(GraphHazardTest, EveryRemovedBarrierIsMissed) {
  Mutations removed;
  for (uint32_t seed = 1; seed <= graphs; ++seed) {
    const RandomGraph random(seed);
    const Plan plan = compile(random.graph, {.alias = false});
    for (size_t i = 0; i < plan.barriers.size(); ++i)
      removed.add(Replay(random.graph, plan).run(int(i)), describe(random.graph, plan, seed, i));
  }
  removed.expect_all("removed barriers");
}

// Every single bit of every scope is needed: nothing is synchronised that need not be. One exception: a read that is
// also a write names its read access again, although an earlier barrier has made the same content visible to it.
TEST(GraphHazardTest, EveryWeakenedBarrierIsMissed) {
  Mutations weakened;
  for (uint32_t seed = 1; seed <= graphs; ++seed) {
    const RandomGraph random(seed);
    Plan plan = compile(random.graph, {.alias = false});
    for (size_t i = 0; i < plan.barriers.size(); ++i) {
      Barrier& barrier = plan.barriers[i];
      for (VkFlags64* scope : {&barrier.src_stages, &barrier.dst_stages, &barrier.src_access, &barrier.dst_access}) {
        const VkFlags64 whole = *scope;
        for_each_bit(whole, [&](uint64_t bit) {
          const bool again = !barrier.src_access && barrier.old_layout == barrier.new_layout;
          if (again && scope == &barrier.dst_access && whole != bit && bit == storage_read) return;
          *scope = whole & ~bit;
          weakened.add(Replay(random.graph, plan).run(), describe(random.graph, plan, seed, i));
        });
        *scope = whole;
      }
    }
  }
  weakened.expect_all("weakened barriers");
}

}  // namespace
}  // namespace nf::graph
