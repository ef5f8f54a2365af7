// Placement of transients by byte ranges: resources whose lifetimes do not meet may share bytes. It is dynamic storage
// allocation (NP-complete); greedy orders and a bounded number of seeded swaps come within a few per cent of the bound.
// A pure function: the same items give the same offsets.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace nf::graph {

// Alive at the positions [first, last] of the frame. `align` is a power of two.
struct PlaceItem {
  uint64_t size = 0, align = 1;
  uint32_t first = 0, last = 0;
};

struct Placement {
  std::vector<uint64_t> offset;  // by item
  uint64_t top = 0;              // bytes of the heap
};

// The largest sum of aligned sizes alive at one position: no placement needs less.
uint64_t max_live(std::span<const PlaceItem> items);

// Tries four greedy orders (size, size x lifetime, lifetime, first use), then swaps of the best one until the bound is
// met or `swaps` were tried. Among places of equal top the one free the longest is taken: fewer waits between
// neighbours.
Placement place(std::span<const PlaceItem> items, uint32_t swaps = 500);

// Who owned an item's bytes before it, going round the frame: the frame's first users follow the last ones of the frame
// before. Sorted; an item that shares with nobody is its own predecessor.
std::vector<std::vector<uint32_t>> alias_predecessors(std::span<const PlaceItem> items,
                                                      std::span<const uint64_t> offset);

}  // namespace nf::graph
