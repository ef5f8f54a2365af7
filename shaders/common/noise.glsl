// Sampling noise per pixel and frame: one Kronecker sequence along a Hilbert curve in space, another over the frames (Roberts
// 2018, generalised golden ratios). Integer arithmetic, so the same on every device. Compiles as GLSL and C++.
#ifndef NF_COMMON_NOISE_GLSL
#define NF_COMMON_NOISE_GLSL

const float GOLDEN = 0.618033988749895f;

// Index of a pixel along the Hilbert curve that fills its 64 x 64 tile.
uint hilbert_index(uint x, uint y) {
  x &= 63u;
  y &= 63u;
  uint index = 0u;
  for (uint half_size = 32u; half_size > 0u; half_size >>= 1) {
    uint right = (x & half_size) != 0u ? 1u : 0u;
    uint upper = (y & half_size) != 0u ? 1u : 0u;
    index += half_size * half_size * ((3u * right) ^ upper);
    if (upper == 0u) {
      uint flip = right * 63u;
      uint swapped = x ^ flip;
      x = y ^ flip;
      y = swapped;
    }
  }
  return index;
}

// PCG output permutation (O'Neill 2014) as a hash.
uint hash_uint(uint x) {
  uint state = x * 747796405u + 2891336453u;
  uint word = ((state >> ((state >> 28) + 4u)) ^ state) * 277803737u;
  return (word >> 22) ^ word;
}

float unit_float(uint bits) { return float(bits >> 8) * (1.0f / 16777216.0f); }

// x: rotation of the slices, y: step jitter, z: sector jitter; each uniform in [0, 1), independent of the others.
// In space the multipliers are 2^32 / g^i with g^4 = g + 1 (R3). In time they are others, so that frames do not merely move
// the pattern along the curve: the golden ratio, best in one dimension, for the slices, R2 for the other two. Of ten such
// pairs this did best over 4 to 64 frames, blocks of 2 to 8 pixels, and both together (white noise: 1.5 to 3 times its error).
vec3 sampling_noise(ivec2 pixel, uint frame_index, uint seed) {
  uint h = hilbert_index(uint(pixel.x), uint(pixel.y));
  uint x = h * 3518319155u + frame_index * 2654435769u + hash_uint(seed);
  uint y = h * 2360945575u + frame_index * 2447445413u + hash_uint(seed + 0x9E3779B9u);
  uint z = h * 2882110345u + frame_index * 3242174889u + hash_uint(seed + 0x3C6EF372u);
  return vec3(unit_float(x), unit_float(y), unit_float(z));
}

// A number of its own for every step of every march; a march is one side of one slice.
int step_index(int march, int step_number, int steps) { return march * steps + step_number; }

// Golden-ratio rotation: neighbours in index are far apart in value.
float rotated(float noise, int index) { return fract(noise + float(index) * GOLDEN); }

#endif
