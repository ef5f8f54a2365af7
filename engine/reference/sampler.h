// Numbers in [0, 1) for a pixel's sample, dimension after dimension. Sobol: two-dimensional Sobol points,
// Owen-scrambled and shuffled anew for every pair of dimensions (Burley 2020, "Practical Hash-based Owen Scrambling").
// Independent: a hash of everything. Nothing is stored, so that any sample can be taken by any thread.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>

#include "reference/reference.h"

namespace nf::reference {

// SplitMix64's output function (Steele et al. 2014).
inline uint64_t mix(uint64_t x) {
  x += 0x9E3779B97F4A7C15u;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
  return x ^ (x >> 31);
}

inline uint32_t reverse_bits(uint32_t x) {
  x = x << 16 | x >> 16;
  x = (x & 0x00ff00ffu) << 8 | (x & 0xff00ff00u) >> 8;
  x = (x & 0x0f0f0f0fu) << 4 | (x & 0xf0f0f0f0u) >> 4;
  x = (x & 0x33333333u) << 2 | (x & 0xccccccccu) >> 2;
  return (x & 0x55555555u) << 1 | (x & 0xaaaaaaaau) >> 1;
}

// Nested uniform scrambling: every bit is flipped by a hash of the bits above it. A product with an even number plus
// odd multiples lets a bit depend on lower ones only, which after reversal are the higher ones (Laine and Karras 2011).
inline uint32_t owen_scramble(uint32_t x, uint32_t seed) {
  x = reverse_bits(x);
  x += seed;
  x ^= x * 0x6c50b47cu;
  x ^= x * 0xb82f1e52u;
  x ^= x * 0xc7afe638u;
  x ^= x * 0x8d22f6e6u;
  return reverse_bits(x);
}

// The second dimension of Sobol's sequence; the first is the reversed index.
inline uint32_t sobol_second(uint32_t index) {
  static constexpr std::array<uint32_t, 32> directions = [] {
    std::array<uint32_t, 32> v{};
    v[0] = 1u << 31;
    for (size_t k = 1; k < 32; ++k) v[k] = v[k - 1] ^ v[k - 1] >> 1;
    return v;
  }();
  uint32_t x = 0;
  for (size_t bit = 0; index != 0; ++bit, index >>= 1)
    if (index & 1) x ^= directions[bit];
  return x;
}

class Stream {
 public:
  Stream(SamplerKind kind, uint64_t pixel_key, uint32_t index) : kind_(kind), key_(pixel_key), index_(index) {}

  glm::vec2 next2() {
    const uint64_t key = mix(key_ + dimension_++);
    if (kind_ == SamplerKind::Independent) {
      const uint64_t bits = mix(key ^ (uint64_t(index_) << 1 | 1) * 0xD6E8FEB86659FD93u);
      return {unit(uint32_t(bits)), unit(uint32_t(bits >> 32))};
    }
    const uint64_t more = mix(key);
    const uint32_t index = owen_scramble(index_, uint32_t(more));
    return {unit(owen_scramble(reverse_bits(index), uint32_t(key))),
            unit(owen_scramble(sobol_second(index), uint32_t(key >> 32)))};
  }
  float next1() { return next2().x; }

 private:
  static float unit(uint32_t bits) { return float(bits >> 8) * (1.0f / 16777216.0f); }

  SamplerKind kind_;
  uint64_t key_;
  uint32_t index_;
  uint32_t dimension_ = 0;
};

}  // namespace nf::reference
