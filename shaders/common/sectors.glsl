// Bit masks over the sectors of a slice, bit j = sector j. The including file may say how many there are: SECTOR_COUNT, in
// MASK_WORDS words. The text compiles as GLSL and as C++ (tests/glsl_twin.h).
#ifndef NF_COMMON_SECTORS_GLSL
#define NF_COMMON_SECTORS_GLSL

#ifndef SECTOR_COUNT
#define SECTOR_COUNT 32
#define MASK_WORDS 1
#endif

// Bits [0, n). The shift count stays in 0..31: a shift by 32 is undefined in GLSL, SPIR-V and C++.
uint low_mask(int n) { return (n > 31 ? 0u : 1u << uint(clamp(n, 0, 31))) - 1u; }

// Bits [a, b); empty when a >= b.
uint sector_mask(int a, int b) { return low_mask(b) & ~low_mask(a); }

// Bits between a and b in either order: what the marcher needs, since positions run downwards on one side of V.
uint sector_span(int a, int b) { return low_mask(a) ^ low_mask(b); }

// The same for word `word` of a mask of several words: sectors 32 * word .. 32 * word + 31.
uint sector_span_word(int a, int b, int word) { return sector_span(a - 32 * word, b - 32 * word); }

struct Mask {
  uint words[MASK_WORDS];
};

Mask empty_mask() {
  Mask mask;
  for (int i = 0; i < MASK_WORDS; ++i) mask.words[i] = 0u;
  return mask;
}

#endif
