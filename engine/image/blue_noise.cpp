// Void and cluster. Every point that is set adds a Gaussian of energy around it; the tightest cluster is the set point
// of most energy, the largest void the free one of least.
#include "image/blue_noise.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace nf::image {
namespace {

constexpr double sigma = 1.9;        // points
constexpr uint32_t unit = 1u << 20;  // energy of a point at itself
constexpr uint32_t never = 0xffffffff;

uint32_t gaussian(int64_t distance2) {
  return uint32_t(std::lround(unit * std::exp(-double(distance2) / (2 * sigma * sigma))));
}

// Distance along an axis that wraps around.
int64_t wrapped(uint32_t distance, uint32_t length) {
  return std::min(distance, length - distance);
}

class Field {
 public:
  explicit Field(uint32_t side) : side_(side), energy_(size_t(side) * side), set_(energy_.size()), rows_(side) {
    for (uint32_t y = 0; y < side; ++y)
      for (uint32_t x = 0; x < side; ++x)
        if (const uint32_t e = gaussian(wrapped(x, side) * wrapped(x, side) + wrapped(y, side) * wrapped(y, side)))
          kernel_.push_back({x, y, e});
  }

  void put(uint32_t at, bool on) {
    set_[at] = on;
    const uint32_t x = at % side_, y = at / side_;
    for (const Tap& tap : kernel_) {
      const uint32_t row = (y + tap.y) % side_;
      add(row * side_ + (x + tap.x) % side_, on, tap.energy);
      rows_[row].stale = true;
    }
  }

  uint32_t tightest_cluster() { return extreme(true); }
  uint32_t largest_void() { return extreme(false); }
  bool is_set(uint32_t at) const { return set_[at]; }
  uint32_t size() const { return uint32_t(energy_.size()); }

 private:
  struct Tap {
    uint32_t x, y, energy;
  };
  // The extreme of one row of points, so that a change costs some rows and not the whole array.
  struct Row {
    uint32_t key = never;
    bool stale = true;
  };

  void add(uint32_t at, bool on, uint32_t energy) { energy_[at] += on ? energy : 0 - energy; }
  // The least is looked for: of set points energy counts upside down, and points not looked for have the most there is.
  uint32_t key(uint32_t at, bool of_set) const {
    const uint32_t free = set_[at] - 1;  // all bits or none
    return of_set ? ~energy_[at] | free : energy_[at] | ~free;
  }
  template <bool of_set>
  void refresh() {
    for (uint32_t r = 0; r < rows_.size(); ++r) {
      if (!rows_[r].stale) continue;
      uint32_t least = never;
      for (uint32_t at = r * side_; at < (r + 1) * side_; ++at) least = std::min(least, key(at, of_set));
      rows_[r] = {least, false};
    }
  }
  uint32_t extreme(bool of_set) {
    if (of_set != rows_of_set_)
      for (Row& row : rows_) row.stale = true;
    rows_of_set_ = of_set;
    of_set ? refresh<true>() : refresh<false>();
    const auto row =
        std::min_element(rows_.begin(), rows_.end(), [](const Row& a, const Row& b) { return a.key < b.key; });
    uint32_t at = uint32_t(row - rows_.begin()) * side_;
    while (key(at, of_set) != row->key) ++at;
    return at;
  }

  uint32_t side_;
  std::vector<uint32_t> energy_;
  std::vector<uint32_t> set_;
  std::vector<Row> rows_;
  bool rows_of_set_ = false;
  std::vector<Tap> kernel_;
};

}  // namespace

std::vector<uint32_t> void_and_cluster(uint32_t side, uint32_t seed) {
  Field field(side);
  const uint32_t count = field.size(), first = count / 10;
  std::mt19937 random(seed);
  for (uint32_t placed = 0; placed < first;)
    if (const uint32_t at = uint32_t(random() % count); !field.is_set(at)) field.put(at, true), ++placed;
  // Move points from clusters into voids until the void that a point leaves is the largest.
  for (uint32_t from = never, to = 0; from != to;) {
    from = field.tightest_cluster();
    field.put(from, false);
    to = field.largest_void();
    field.put(to, true);
  }
  std::vector<uint32_t> ranks(count);
  Field thinned = field;
  for (uint32_t rank = first; rank-- > 0;) {
    const uint32_t at = thinned.tightest_cluster();
    thinned.put(at, false);
    ranks[at] = rank;
  }
  // Beyond half the tightest cluster of free points is what counts: where the energies of set and free points add up to
  // the same everywhere, as they do here, that is the largest void still.
  for (uint32_t rank = first; rank < count; ++rank) {
    const uint32_t at = field.largest_void();
    field.put(at, true);
    ranks[at] = rank;
  }
  return ranks;
}

}  // namespace nf::image
