// Making plans real, and keeping them: images and buffers in shared heaps, histories, read-back buffers. What is no
// longer needed is destroyed when the last frame that used it is done; nothing waits for the device.
#include <algorithm>

#include "core/log.h"
#include "graph/executor.h"
#include "graph/hazards.h"

namespace nf::graph {
namespace {

constexpr size_t most_plans = 8;  // toggles of an editor flip between a few graphs, and so does what moves and rests

gpu::ImageInfo image_info(const ImageDesc& desc, VkImageUsageFlags usage) {
  return {.extent = {desc.size.width, desc.size.height},
          .format = desc.format,
          .mips = desc.mips,
          .layers = desc.layers,
          .usage = usage};
}

void require_no_hazards(const Graph& graph, const Plan& plan) {
  const std::vector<std::string> found = find_hazards(graph, plan);
  if (found.empty()) return;
  std::string text = "the plan of the frame has hazards (a fault of the engine, please report it):";
  for (const std::string& line : found) text += "\n  " + line;
  throw Error(Exit::Internal, text);
}

}  // namespace

Executor::Executor(gpu::Device& device, gpu::Pipelines& pipelines, const ExecutorOptions& wanted)
    : options(wanted), device_(device), pipelines_(pipelines), ring_(device) {}

Executor::~Executor() {
  device_.wait_idle();
  while (!plans_.empty()) evict(0);
  drop_unused_histories();
  for (SharedHeap& heap : heaps_) {
    retired_.push_back({.frame = 0, .image = {}, .buffer = heap.cover, .heap = {}});
    retired_.push_back({.frame = 0, .image = {}, .buffer = {}, .heap = heap.heap});
  }
  collect(ring_.submitted());
}

Plan Executor::plan_for(const Graph& graph) const {
  return compile(graph, {.alias = options.alias,
                         .layouts = options.layouts,
                         .order_seed = options.order_seed,
                         .needs = [this](const ResourceRow& row, VkFlags usage) {
                           return row.is_buffer ? gpu::buffer_needs(device_, row.bytes, usage)
                                                : gpu::image_needs(device_, image_info(row.desc, usage));
                         }});
}

// The current plan becomes the graph's.
void Executor::select_plan(const Graph& graph) {
  uint64_t hash = topology_hash(graph);
  for (const uint64_t option : {uint64_t(options.alias), uint64_t(options.layouts), options.order_seed})
    hash = (hash ^ option) * 0x9E3779B97F4A7C15ull;
  if (current_ < plans_.size() && plans_[current_].hash == hash) return;
  switched_ = true;
  for (size_t i = 0; i < plans_.size(); ++i)
    if (plans_[i].hash == hash) {
      current_ = i;
      return;
    }
  require_valid(graph);
  RealPlan real{.hash = hash, .plan = plan_for(graph)};
#ifdef NDEBUG
  const bool check = device_.validation;
#else
  const bool check = true;
#endif
  if (check) require_no_hazards(graph, real.plan);
  if (plans_.size() == most_plans) {
    const auto oldest = std::min_element(plans_.begin(), plans_.end(),
                                         [](const RealPlan& a, const RealPlan& b) { return a.last_run < b.last_run; });
    evict(size_t(oldest - plans_.begin()));
  }
  try {
    realize(graph, real);
  } catch (...) {
    retire(real);
    throw;
  }
  plans_.push_back(std::move(real));
  current_ = plans_.size() - 1;
  drop_unused_histories();
  ++replans_;
}

void Executor::realize(const Graph& graph, RealPlan& real) {
  const Plan& plan = real.plan;
  real.resources.resize(graph.resources.size());
  real.histories.assign(graph.resources.size(), nullptr);
  for (const PlannedHeap& heap : plan.heaps) real.heaps.push_back(find_heap(heap));
  for (uint16_t r = 0; r < graph.resources.size(); ++r) {
    const ResourceRow& row = graph.resources[r];
    const PlannedResource& planned = plan.resources[r];
    if (row.lifetime == Lifetime::HistoryPrev && (planned.live || plan.resources[row.pair].live))
      real.histories[r] = real.histories[row.pair] = find_history(row);
    if (row.lifetime == Lifetime::Kept && planned.live) real.histories[r] = find_history(row);
    if (row.lifetime != Lifetime::Transient || !planned.live) continue;
    Physical& physical = real.resources[r];
    const gpu::Heap* heap = planned.heap < 0 ? nullptr : &heaps_[real.heaps[size_t(planned.heap)]].heap;
    if (row.is_buffer)
      physical.buffer = heap ? place_buffer(device_, row.bytes, planned.usage, row.name, *heap, planned.offset)
                             : create_buffer(device_, row.bytes, planned.usage, gpu::Where::Device, row.name);
    else
      physical.image = heap
                           ? place_image(device_, image_info(row.desc, planned.usage), row.name, *heap, planned.offset)
                           : create_image(device_, image_info(row.desc, planned.usage), row.name, gpu::WholeView::None);
  }
  for (const PassRow& pass : graph.passes) {
    if (pass.kind != PassKind::Readback) continue;
    const UseRow& use = graph.uses[pass.first_use];
    const ResourceRow& row = graph.resources[use.resource];
    ReadbackRow back{{pass.one_texel ? Size{} : size_of(row.desc, use.part.mip), row.desc.format}, {}};
    const uint64_t bytes =
        row.is_buffer ? row.bytes
                      : uint64_t(back.desc.size.width) * back.desc.size.height * gpu::texel_bytes(row.desc.format);
    back.buffer = create_buffer(device_, bytes, VK_BUFFER_USAGE_TRANSFER_DST_BIT, gpu::Where::Host, pass.name);
    real.readbacks.push_back(back);
  }
}

// A heap of this kind that is large enough. One that is too small goes, with the plans that were placed in it.
size_t Executor::find_heap(const PlannedHeap& wanted) {
  constexpr uint64_t granule = 65536;
  const uint64_t size = (wanted.size + granule - 1) / granule * granule;
  const char* name = wanted.buffers ? "the heap of transient buffers" : "the heap of transient images";
  for (size_t h = 0; h < heaps_.size(); ++h) {
    SharedHeap& shared = heaps_[h];
    if (shared.buffers != wanted.buffers || shared.heap.type_bits != wanted.type_bits) continue;
    if (shared.heap.size >= wanted.size) return h;
    for (size_t i = plans_.size(); i-- > 0;)
      if (std::count(plans_[i].heaps.begin(), plans_[i].heaps.end(), h)) evict(i);
    const gpu::Heap larger = create_heap(device_, size, wanted.type_bits, name);
    retired_.push_back({.frame = ring_.submitted(), .image = {}, .buffer = shared.cover, .heap = {}});
    retired_.push_back({.frame = ring_.submitted(), .image = {}, .buffer = {}, .heap = shared.heap});
    shared.heap = larger;
    shared.cover = {};
    return h;
  }
  heaps_.push_back({wanted.buffers, create_heap(device_, size, wanted.type_bits, name), {}});
  return heaps_.size() - 1;
}

// By name and description. The same name with another description is the picture before a resize: it goes, with the
// plans that used it.
Executor::PhysicalHistory* Executor::find_history(const ResourceRow& row) {
  for (const auto& history : histories_) {
    if (history->name != row.name) continue;
    if (history->desc == row.desc && history->bytes == row.bytes) return history.get();
    for (size_t i = plans_.size(); i-- > 0;)
      if (std::count(plans_[i].histories.begin(), plans_[i].histories.end(), history.get())) evict(i);
  }
  auto history = std::make_unique<PhysicalHistory>();
  history->name = row.name;
  history->desc = row.desc;
  history->bytes = row.bytes;
  PhysicalHistory* made = history.get();
  histories_.push_back(std::move(history));  // owned, should the device refuse the second side
  for (Physical& side : std::span(made->sides, row.lifetime == Lifetime::Kept ? 1 : 2)) {
    // Every usage there is: another plan may use it otherwise, and its content must live on.
    constexpr VkBufferUsageFlags any_use = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT |
                                           VK_BUFFER_USAGE_INDEX_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT |
                                           VK_BUFFER_USAGE_TRANSFER_DST_BIT;
    if (row.is_buffer)
      side.buffer = create_buffer(device_, row.bytes, any_use, gpu::Where::Device, row.name);
    else
      side.image = create_image(device_, image_info(row.desc, gpu::possible_usage(device_, row.desc.format)), row.name,
                                gpu::WholeView::None);
  }
  for (auto& layouts : made->layouts) layouts.assign(cell_count(row), VK_IMAGE_LAYOUT_UNDEFINED);
  return made;
}

void Executor::evict(size_t plan) {
  retire(plans_[plan]);
  plans_.erase(plans_.begin() + ptrdiff_t(plan));
  if (current_ == plan)
    current_ = plans_.size() + most_plans;  // none
  else if (current_ > plan)
    --current_;
}

void Executor::retire(RealPlan& real) {
  for (Physical& physical : real.resources) retire(physical);
  for (ReadbackRow& back : real.readbacks)
    retired_.push_back({.frame = ring_.submitted(), .image = {}, .buffer = back.buffer, .heap = {}});
}

void Executor::retire(Physical& physical) {
  const uint64_t frame = ring_.submitted();
  for (const View& view : physical.views)
    retired_.push_back({.frame = frame, .view = view.view, .image = {}, .buffer = {}, .heap = {}});
  retired_.push_back({.frame = frame, .image = physical.image, .buffer = physical.buffer, .heap = {}});
  physical = {};
}

void Executor::drop_unused_histories() {
  std::erase_if(histories_, [&](const std::unique_ptr<PhysicalHistory>& history) {
    for (const RealPlan& real : plans_)
      if (std::count(real.histories.begin(), real.histories.end(), history.get())) return false;
    for (Physical& side : history->sides) retire(side);
    return true;
  });
}

// In the order in which they were retired: views before images, these before heaps.
void Executor::collect(uint64_t finished) {
  size_t done = 0;
  for (; done < retired_.size() && retired_[done].frame <= finished; ++done) {
    Retired& row = retired_[done];
    destroy_view(device_, row.view);
    destroy(device_, row.image);
    destroy(device_, row.buffer);
    destroy(device_, row.heap);
  }
  retired_.erase(retired_.begin(), retired_.begin() + ptrdiff_t(done));
}

Executor::Physical& Executor::physical(const Graph& graph, uint16_t resource) {
  RealPlan& real = plans_[current_];
  if (PhysicalHistory* history = real.histories[resource]) {
    const Lifetime lifetime = graph.resources[resource].lifetime;
    return history->sides[lifetime == Lifetime::Kept ? 0 : lifetime == Lifetime::HistoryNext ? parity_ : 1 - parity_];
  }
  return real.resources[resource];
}

VkBuffer Executor::buffer(const Graph& graph, uint16_t resource) {
  const gpu::Buffer* imported = graph.resources[resource].imported;
  return imported ? imported->handle : physical(graph, resource).buffer.handle;
}

VkImageView Executor::view(Physical& physical, const Part& part, VkImageViewType type) {
  for (const View& view : physical.views)
    if (view.part == part && view.type == type) return view.view;
  const VkImageView made =
      create_view(device_, physical.image, type,
                  {gpu::aspect_of(physical.image.info.format), part.mip, part.mips, part.layer, part.layers});
  physical.views.push_back({part, type, made});
  return made;
}

}  // namespace nf::graph
