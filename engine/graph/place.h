// Placement of transients by byte ranges: resources whose lifetimes do not meet may share bytes. It is dynamic storage
// allocation (NP-complete); greedy orders and a bounded number of seeded repairs come within a few parts in a thousand
// of the bound. A pure function: the same items give the same offsets on every machine.
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

// Bytes that no placement of these items in one heap goes below. Of the items alive at one position, take those whose
// alignment is at least A: each begins at a multiple of A, so all but the topmost take align_up(size, A). The largest
// such sum over positions and alignments; for the smallest alignment it is at least the plain sum of sizes.
uint64_t max_live(std::span<const PlaceItem> items);

// Tries four greedy orders (size, size x lifetime, lifetime, first use), then repairs of the best one: at most `tries`,
// fewer where the bound is near or the items are many. Among the places that keep the top, an item takes the one whose
// bytes are unused the longest before and after it: fewer waits between neighbours.
Placement place(std::span<const PlaceItem> items, uint32_t tries = 500);

// Who owned an item's bytes before it, going round the frame: the frame's first users follow the last ones of the frame
// before. Sorted; an item that shares with nobody is its own predecessor.
std::vector<std::vector<uint32_t>> alias_predecessors(std::span<const PlaceItem> items,
                                                      std::span<const uint64_t> offset);

}  // namespace nf::graph
