// The bound, greedy placement with repairs, and the interval map of owners.
#include "graph/place.h"

#include <algorithm>
#include <numeric>
#include <queue>

namespace nf::graph {
namespace {

constexpr uint64_t none = UINT64_MAX;

struct Range {
  uint64_t begin, end;
};

// One placed item, in the list sorted by `begin`.
struct Row {
  Range bytes;
  uint32_t first, last;
};

// What the attempts share. Who may be in an item's way is found in one of two ways: where lifetimes are short, a list
// of those alive together with it; else that would be long and its sorting dear, and all placed items are kept sorted.
struct Packer {
  std::span<const PlaceItem> items;
  std::vector<uint32_t> neighbours, first_neighbour;  // those of i: [first_neighbour[i], first_neighbour[i + 1])
  std::vector<Row> rows;                              // used when there are no lists
  std::vector<Range> at;                              // by item; {0, 0}: not placed
  std::vector<Range> taken;                           // room for find_taken
  uint64_t work = 0;                                  // what was looked at, in units of about 1 ns

  bool sparse() const { return !first_neighbour.empty(); }
};

uint64_t align_up(uint64_t value, uint64_t align) {
  return (value + align - 1) & ~(align - 1);
}
uint64_t align_down(uint64_t value, uint64_t align) {
  return value & ~(align - 1);
}

template <typename Key>
std::vector<uint32_t> sorted_by(size_t count, Key key) {
  std::vector<uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return key(a) < key(b); });
  return order;
}

Packer make_packer(std::span<const PlaceItem> items) {
  const size_t count = items.size();
  Packer packer{.items = items};
  packer.at.resize(count);
  packer.taken.resize(count);
  // Measured: with more than a twentieth of the pairs alive together the sorted list is the faster one.
  const size_t most = std::min(count * count / 40, 128 * count);
  std::vector<std::pair<uint32_t, uint32_t>> pairs;
  std::vector<uint32_t> alive;
  for (const uint32_t item : sorted_by(count, [&](uint32_t i) { return items[i].first; })) {
    std::erase_if(alive, [&](uint32_t other) { return items[other].last < items[item].first; });
    if (pairs.size() + alive.size() > most) {
      packer.rows.reserve(count);
      return packer;
    }
    for (const uint32_t other : alive) pairs.emplace_back(item, other);
    alive.push_back(item);
  }
  packer.first_neighbour.assign(count + 1, 0);
  for (const auto& [a, b] : pairs) ++packer.first_neighbour[a], ++packer.first_neighbour[b];
  std::partial_sum(packer.first_neighbour.begin(), packer.first_neighbour.end(), packer.first_neighbour.begin());
  packer.neighbours.resize(2 * pairs.size());
  for (const auto& [a, b] : pairs) {
    packer.neighbours[--packer.first_neighbour[a]] = b;
    packer.neighbours[--packer.first_neighbour[b]] = a;
  }
  return packer;
}

// The bytes of the placed items alive together with `item`, sorted by their begin.
std::span<const Range> find_taken(Packer& packer, uint32_t item) {
  const PlaceItem& it = packer.items[item];
  size_t count = 0;
  if (packer.sparse()) {
    const uint32_t begin = packer.first_neighbour[item], end = packer.first_neighbour[item + 1];
    for (uint32_t i = begin; i < end; ++i) {
      packer.taken[count] = packer.at[packer.neighbours[i]];
      count += packer.taken[count].end != 0;
    }
    std::sort(packer.taken.begin(), packer.taken.begin() + ptrdiff_t(count),
              [](const Range& a, const Range& b) { return a.begin < b.begin; });
    packer.work += 8 * (end - begin);
  } else {
    for (const Row& row : packer.rows) {
      packer.taken[count] = row.bytes;
      count += size_t(row.first <= it.last) & size_t(it.first <= row.last);
    }
    packer.work += packer.rows.size();
  }
  return std::span(packer.taken).first(count);
}

void put(Packer& packer, uint32_t item, uint64_t offset) {
  const PlaceItem& it = packer.items[item];
  packer.at[item] = {offset, offset + it.size};
  if (packer.sparse()) return;
  const auto behind = std::upper_bound(packer.rows.begin(), packer.rows.end(), offset,
                                       [](uint64_t value, const Row& row) { return value < row.bytes.begin; });
  packer.rows.insert(behind, {packer.at[item], it.first, it.last});
}

void take_out(Packer& packer, uint32_t item) {
  const PlaceItem& it = packer.items[item];
  const Range bytes = packer.at[item];
  packer.at[item] = {0, 0};
  if (packer.sparse()) return;
  auto row = std::lower_bound(packer.rows.begin(), packer.rows.end(), bytes.begin,
                              [](const Row& r, uint64_t value) { return r.bytes.begin < value; });
  while (row->bytes.end != bytes.end || row->first != it.first || row->last != it.last) ++row;
  packer.rows.erase(row);
}

uint64_t lowest_fit(std::span<const Range> taken, const PlaceItem& item) {
  uint64_t at = 0;
  for (const Range& range : taken) {
    if (at + item.size <= range.begin) break;
    at = std::max(at, align_up(range.end, item.align));
  }
  return at;
}

struct Attempt {
  uint64_t top = 0;     // none: an item did not fit below the limit
  uint32_t blamed = 0;  // where in the order is the item that did not fit, or else the one that made the top
};

// First fit in the given order, given up at the first item that would end above the limit.
Attempt place_in_order(Packer& packer, std::span<const uint32_t> order, uint64_t limit) {
  packer.rows.clear();
  std::fill(packer.at.begin(), packer.at.end(), Range{});
  Attempt result;
  for (uint32_t i = 0; i < order.size(); ++i) {
    const PlaceItem& item = packer.items[order[i]];
    const uint64_t offset = lowest_fit(find_taken(packer, order[i]), item);
    if (offset + item.size > limit) return {none, i};
    if (offset + item.size > result.top) result = {offset + item.size, i};
    put(packer, order[i], offset);
  }
  return result;
}

// SplitMix64: the repairs must be the same on every machine.
uint64_t next_random(uint64_t& state) {
  uint64_t z = (state += 0x9E3779B97F4A7C15ull);
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
  return z ^ (z >> 31);
}

struct Search {
  std::vector<Range> at;
  uint64_t top = none;
  std::vector<uint32_t> order;  // of the last attempt, and in it
  uint32_t blamed = 0;          // who is to move
};

Search place_greedily(Packer& packer, uint64_t bound) {
  Search best;
  const auto attempt = [&](auto key) {
    if (best.top == bound) return;
    std::vector<uint32_t> order = sorted_by(packer.items.size(), key);
    const Attempt result = place_in_order(packer, order, best.top - 1);
    if (result.top != none) best = {packer.at, result.top, std::move(order), result.blamed};
  };
  // The complement sorts descending.
  const auto size = [&](uint32_t i) { return packer.items[i].size; };
  const auto life = [&](uint32_t i) { return uint64_t(packer.items[i].last - packer.items[i].first + 1); };
  attempt([&](uint32_t i) { return ~size(i); });
  attempt([&](uint32_t i) { return ~(size(i) * life(i)); });
  attempt([&](uint32_t i) { return std::pair(~life(i), ~size(i)); });
  attempt([&](uint32_t i) { return std::pair(packer.items[i].first, ~size(i)); });
  return best;
}

// Squeaky-wheel optimisation (Joslin and Clements 1999): the item that did not fit moves to the front half of those
// before it. Every second attempt aims half way to the bound, the others at anything below the best. What there is to
// gain decides how many there are: `tries` for a sixty-fourth of the bound or more.
void repair(Packer& packer, uint64_t bound, uint32_t tries, Search& best) {
  const uint64_t most_work = packer.work + 8000 * uint64_t(tries);
  uint64_t random = 1;
  for (uint64_t i = 0; i < tries && best.top > bound && packer.work < most_work; ++i) {
    const uint64_t gap = best.top - bound;
    if (gap * 64 * tries < i * bound) break;
    const uint32_t to = uint32_t(next_random(random) % (best.blamed / 2 + 1));
    const auto begin = best.order.begin();
    std::rotate(begin + to, begin + best.blamed, begin + best.blamed + 1);
    const Attempt result = place_in_order(packer, best.order, bound + (i % 2 ? gap - 1 : (gap - 1) / 2));
    best.blamed = result.blamed;
    if (result.top != none) best.top = result.top, best.at = packer.at;
  }
}

// The frame as a ring: its first position follows its last one.
struct Ring {
  std::vector<uint32_t> by_first, by_last;
  uint32_t positions = 0;
  uint32_t horizon = 0;  // users further away than this are all equally far: nothing waits for them any more
};

Ring make_ring(std::span<const PlaceItem> items) {
  Ring ring{.by_first = sorted_by(items.size(), [&](uint32_t i) { return items[i].first; }),
            .by_last = sorted_by(items.size(), [&](uint32_t i) { return items[i].last; })};
  ring.positions = items[ring.by_last.back()].last + 1;
  ring.horizon = std::min(ring.positions, 64u);
  return ring;
}

// How many positions lie between the item and the nearest user of the bytes it would have, before or after it; need not
// be exact below `enough`.
uint32_t unused_around(const Packer& packer, const Ring& ring, const PlaceItem& item, uint64_t offset,
                       uint32_t enough) {
  const std::span<const PlaceItem> items = packer.items;
  uint32_t distance = ring.horizon;
  // Both walks go outwards in time, so the first user they meet is the nearest.
  const auto ends_walk = [&](uint32_t other, uint32_t from, uint32_t to) {
    const uint32_t d = to > from ? to - from : to + ring.positions - from;
    if (d >= distance) return true;
    if (packer.at[other].begin >= offset + item.size || packer.at[other].end <= offset) return false;
    distance = d;
    return true;
  };
  const auto ended = std::partition_point(ring.by_last.begin(), ring.by_last.end(),
                                          [&](uint32_t i) { return items[i].last < item.first; });
  for (size_t n = items.size(), at = size_t(ended - ring.by_last.begin()), i = 0; i < n; ++i) {
    at = at == 0 ? n - 1 : at - 1;
    if (ends_walk(ring.by_last[at], items[ring.by_last[at]].last, item.first)) break;
  }
  if (distance <= enough) return distance;
  const auto begins = std::partition_point(ring.by_first.begin(), ring.by_first.end(),
                                           [&](uint32_t i) { return items[i].first <= item.last; });
  for (size_t n = items.size(), at = size_t(begins - ring.by_first.begin()), i = 0; i < n; ++i, ++at) {
    if (at == n) at = 0;
    if (ends_walk(ring.by_first[at], item.last, items[ring.by_first[at]].first)) break;
  }
  return distance;
}

// The lowest and the highest place in every hole below the top.
void find_places(std::span<const Range> taken, const PlaceItem& item, uint64_t top, std::vector<uint64_t>& places) {
  places.clear();
  const auto offer = [&](uint64_t begin, uint64_t end) {
    const uint64_t lowest = align_up(begin, item.align);
    if (lowest + item.size > end) return;
    places.push_back(lowest);
    const uint64_t highest = align_down(end - item.size, item.align);
    if (highest > lowest) places.push_back(highest);
  };
  uint64_t cursor = 0;
  for (const Range& range : taken) {
    offer(cursor, range.begin);
    cursor = std::max(cursor, range.end);
  }
  offer(cursor, top);
}

// First fit packs low bytes as soon as they are free; this moves every item, in the frame's order, to the place below
// the top whose bytes are unused the longest around it.
void settle(Packer& packer, uint64_t top) {
  const Ring ring = make_ring(packer.items);
  std::vector<uint64_t> places;
  for (const uint32_t index : ring.by_first) {
    const PlaceItem& item = packer.items[index];
    take_out(packer, index);
    find_places(find_taken(packer, index), item, top, places);
    uint64_t best = places.front();
    uint32_t longest = 0;
    for (size_t i = 0; i < places.size() && places.size() > 1 && longest < ring.horizon; ++i) {
      const uint32_t distance = unused_around(packer, ring, item, places[i], longest);
      if (distance > longest) longest = distance, best = places[i];
    }
    put(packer, index, best);
  }
}

}  // namespace

uint64_t max_live(std::span<const PlaceItem> items) {
  const std::vector<uint32_t> by_first = sorted_by(items.size(), [&](uint32_t i) { return items[i].first; });
  const std::vector<uint32_t> by_last = sorted_by(items.size(), [&](uint32_t i) { return items[i].last; });
  std::vector<uint64_t> aligns;
  for (const PlaceItem& item : items) aligns.push_back(item.align);
  std::sort(aligns.begin(), aligns.end());
  aligns.erase(std::unique(aligns.begin(), aligns.end()), aligns.end());

  uint64_t most = 0;
  for (const uint64_t align : aligns) {
    uint64_t live = 0;
    size_t ended = 0;
    std::priority_queue<std::pair<uint64_t, uint32_t>> padding;  // bytes, last position; dead ones go when they surface
    // The maximum is reached where something begins.
    for (const uint32_t index : by_first) {
      const PlaceItem& item = items[index];
      if (item.align < align) continue;
      for (; items[by_last[ended]].last < item.first; ++ended)
        if (items[by_last[ended]].align >= align) live -= align_up(items[by_last[ended]].size, align);
      const uint64_t padded = align_up(item.size, align);
      live += padded;
      if (padded > item.size) padding.emplace(padded - item.size, item.last);
      while (!padding.empty() && padding.top().second < item.first) padding.pop();
      most = std::max(most, live - (padding.empty() ? 0 : padding.top().first));
    }
  }
  return most;
}

Placement place(std::span<const PlaceItem> items, uint32_t tries) {
  if (items.empty()) return {};
  const uint64_t bound = max_live(items);
  Packer packer = make_packer(items);
  Search best = place_greedily(packer, bound);
  repair(packer, bound, tries, best);

  packer.rows.clear();
  for (uint32_t i = 0; i < items.size(); ++i) put(packer, i, best.at[i].begin);
  settle(packer, best.top);
  Placement result;
  for (const Range& range : packer.at) {
    result.offset.push_back(range.begin);
    result.top = std::max(result.top, range.end);
  }
  return result;
}

std::vector<std::vector<uint32_t>> alias_predecessors(std::span<const PlaceItem> items,
                                                      std::span<const uint64_t> offset) {
  const std::vector<uint32_t> order = sorted_by(items.size(), [&](uint32_t i) { return items[i].first; });

  struct Owned {
    Range bytes;
    uint32_t item;
  };
  std::vector<Owned> owned;  // disjoint, sorted. The first frame fills it, the second one reads off who was there.
  std::vector<std::vector<uint32_t>> result(items.size());
  for (int frame = 0; frame < 2; ++frame)
    for (const uint32_t item : order) {
      const uint64_t begin = offset[item], end = begin + items[item].size;
      const auto from = std::lower_bound(owned.begin(), owned.end(), begin,
                                         [](const Owned& o, uint64_t value) { return o.bytes.end <= value; });
      auto to = from;
      while (to != owned.end() && to->bytes.begin < end) ++to;
      if (frame == 1) {
        std::vector<uint32_t>& before = result[item];
        for (auto it = from; it != to; ++it) before.push_back(it->item);
        std::sort(before.begin(), before.end());
        before.erase(std::unique(before.begin(), before.end()), before.end());
      }
      // What reaches beyond the item's bytes stays with its owner.
      Owned replacement[3];
      ptrdiff_t count = 0;
      if (from != to && from->bytes.begin < begin) replacement[count++] = {{from->bytes.begin, begin}, from->item};
      replacement[count++] = {{begin, end}, item};
      if (from != to && (to - 1)->bytes.end > end) replacement[count++] = {{end, (to - 1)->bytes.end}, (to - 1)->item};
      const ptrdiff_t kept = std::min(count, to - from);
      std::copy_n(replacement, kept, from);
      if (kept < count)
        owned.insert(from + kept, replacement + kept, replacement + count);
      else
        owned.erase(from + kept, to);
    }
  return result;
}

}  // namespace nf::graph
