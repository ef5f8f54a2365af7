// Greedy placement and the interval map of owners.
#include "graph/place.h"

#include <algorithm>
#include <map>
#include <numeric>

namespace nf::graph {
namespace {

uint64_t align_up(uint64_t value, uint64_t align) {
  return (value + align - 1) & ~(align - 1);
}
bool alive_together(const PlaceItem& a, const PlaceItem& b) {
  return a.first <= b.last && b.first <= a.last;
}

// Positions between the end of the item that last used these bytes and this item's start; large when nobody did.
uint32_t free_for(std::span<const PlaceItem> items, std::span<const uint32_t> done, const std::vector<uint64_t>& offset,
                  uint32_t item, uint64_t at) {
  uint32_t shortest = 0xffffffffu;
  for (const uint32_t other : done) {
    const bool meets = offset[other] < at + items[item].size && at < offset[other] + items[other].size;
    if (meets && items[other].last < items[item].first)
      shortest = std::min(shortest, items[item].first - items[other].last);
  }
  return shortest;
}

// First fit in the given order: each item goes to the lowest place that keeps the top lowest.
Placement place_in_order(std::span<const PlaceItem> items, std::span<const uint32_t> order) {
  Placement result{.offset = std::vector<uint64_t>(items.size(), 0)};
  std::vector<uint32_t> done;
  std::vector<std::pair<uint64_t, uint64_t>> taken;  // [begin, end) of those alive together with the item
  for (const uint32_t item : order) {
    taken.clear();
    for (const uint32_t other : done)
      if (alive_together(items[item], items[other]))
        taken.emplace_back(result.offset[other], result.offset[other] + items[other].size);
    std::sort(taken.begin(), taken.end());
    // Every hole's start, and behind the last one.
    uint64_t best = 0, cursor = 0;
    uint32_t best_free = 0;
    bool found = false;
    const auto offer = [&](uint64_t begin, uint64_t end) {
      const uint64_t at = align_up(begin, items[item].align);
      if (at + items[item].size > end) return;
      const uint32_t free = free_for(items, done, result.offset, item, at);
      const bool grows = at + items[item].size > result.top, best_grows = found && best + items[item].size > result.top;
      const bool better =
          !found || (best_grows && (!grows || at < best)) || (!best_grows && !grows && free > best_free);
      if (better) best = at, best_free = free, found = true;
    };
    for (const auto& [begin, end] : taken) {
      if (begin > cursor) offer(cursor, begin);
      cursor = std::max(cursor, end);
    }
    offer(cursor, UINT64_MAX);
    result.offset[item] = best;
    result.top = std::max(result.top, best + items[item].size);
    done.push_back(item);
  }
  return result;
}

// SplitMix64: the swaps must be the same on every machine.
uint64_t next_random(uint64_t& state) {
  uint64_t z = (state += 0x9E3779B97F4A7C15ull);
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
  return z ^ (z >> 31);
}

}  // namespace

uint64_t max_live(std::span<const PlaceItem> items) {
  uint64_t most = 0;
  // The maximum is reached where something begins.
  for (const PlaceItem& start : items) {
    uint64_t live = 0;
    for (const PlaceItem& item : items)
      if (item.first <= start.first && start.first <= item.last) live += align_up(item.size, item.align);
    most = std::max(most, live);
  }
  return most;
}

Placement place(std::span<const PlaceItem> items, uint32_t swaps) {
  if (items.empty()) return {};
  const uint64_t bound = max_live(items);
  const auto life = [&](uint32_t i) { return uint64_t(items[i].last - items[i].first + 1); };
  std::vector<uint32_t> order(items.size()), best_order;
  Placement best;
  const auto attempt = [&](auto greater) {
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), greater);
    Placement candidate = place_in_order(items, order);
    if (best_order.empty() || candidate.top < best.top) best = std::move(candidate), best_order = order;
  };
  attempt([&](uint32_t a, uint32_t b) { return items[a].size > items[b].size; });
  attempt([&](uint32_t a, uint32_t b) { return items[a].size * life(a) > items[b].size * life(b); });
  attempt(
      [&](uint32_t a, uint32_t b) { return life(a) != life(b) ? life(a) > life(b) : items[a].size > items[b].size; });
  attempt([&](uint32_t a, uint32_t b) {
    return items[a].first != items[b].first ? items[a].first < items[b].first : items[a].size > items[b].size;
  });

  uint64_t random = 1;
  for (uint32_t i = 0; i < swaps && best.top > bound; ++i) {
    order = best_order;
    std::swap(order[next_random(random) % order.size()], order[next_random(random) % order.size()]);
    Placement candidate = place_in_order(items, order);
    // Equal tops are taken too: that walks along plateaus.
    if (candidate.top <= best.top) best = std::move(candidate), best_order = order;
  }
  return best;
}

std::vector<std::vector<uint32_t>> alias_predecessors(std::span<const PlaceItem> items,
                                                      std::span<const uint64_t> offset) {
  std::vector<uint32_t> order(items.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return items[a].first < items[b].first; });

  // [begin of bytes] -> (end of bytes, owner). The first frame fills it, the second one reads off who was there.
  std::map<uint64_t, std::pair<uint64_t, uint32_t>> owner;
  std::vector<std::vector<uint32_t>> result(items.size());
  for (int frame = 0; frame < 2; ++frame)
    for (const uint32_t item : order) {
      const uint64_t begin = offset[item], end = begin + items[item].size;
      std::vector<uint32_t>& before = result[item];
      before.clear();
      auto it = owner.upper_bound(begin);
      if (it != owner.begin() && std::prev(it)->second.first > begin) --it;
      while (it != owner.end() && it->first < end) {
        const uint64_t old_begin = it->first, old_end = it->second.first;
        const uint32_t old = it->second.second;
        before.push_back(old);
        it = owner.erase(it);
        if (old_begin < begin) owner[old_begin] = {begin, old};
        if (old_end > end) it = owner.insert_or_assign(end, std::pair(old_end, old)).first;
      }
      owner[begin] = {end, item};
      std::sort(before.begin(), before.end());
      before.erase(std::unique(before.begin(), before.end()), before.end());
    }
  return result;
}

}  // namespace nf::graph
