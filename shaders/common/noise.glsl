// Sampling noise per pixel and frame. A kind of noise is a pattern of three numbers per pixel, and every frame turns all
// pixels by the same step (Roberts 2018, generalised golden ratios), so that the mean over frames converges whatever the kind;
// but of white noise, and of stbn.
// Integer arithmetic, so the same on every device. Compiles as GLSL and C++; shaders choose the kind by defining NOISE_KIND, and
// include common/noise_table.glsl first.
#ifndef NF_COMMON_NOISE_GLSL
#define NF_COMMON_NOISE_GLSL

// As the names of gi.noise.
#define NOISE_HILBERT_R2 0
#define NOISE_IGN 1
#define NOISE_4X4 2
#define NOISE_BLUE 3
#define NOISE_STBN 4
#define NOISE_WHITE 5
#ifndef NOISE_KIND
#define NOISE_KIND NOISE_HILBERT_R2
#endif

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

// The pattern x, y, z (units of 2^-32) after so many turns: the golden ratio, best in one dimension, for the slices, R2 for the
// other two. Of ten such choices with the Hilbert pattern this did best over 4 to 64 frames, blocks of 2 to 8 pixels, and both
// together (white noise: 1.5 to 3 times its error).
vec3 turned(uint x, uint y, uint z, uint turns, uint seed) {
  return vec3(unit_float(x + turns * 2654435769u + hash_uint(seed)),
              unit_float(y + turns * 2447445413u + hash_uint(seed + 0x9E3779B9u)),
              unit_float(z + turns * 3242174889u + hash_uint(seed + 0x3C6EF372u)));
}

// A Kronecker sequence along a Hilbert curve: 2^32 / g^i with g^4 = g + 1 (R3).
vec3 noise_hilbert_r2(ivec2 pixel, uint frame_index, uint seed) {
  uint h = hilbert_index(uint(pixel.x), uint(pixel.y));
  return turned(h * 3518319155u, h * 2360945575u, h * 2882110345u, frame_index, seed);
}

// Interleaved gradient noise (Jimenez 2014): fract(52.9829189 fract(0.06711056 x + 0.00583715 y)) in fixed point.
uint interleaved_gradient(uint x, uint y) { return ((x * 288237660u + y * 25070368u) >> 12) * 217018u; }

// Mirrored and transposed for the other two: a shifted gradient would only be a turned one.
vec3 noise_ign(ivec2 pixel, uint frame_index, uint seed) {
  uint x = uint(pixel.x);
  uint y = uint(pixel.y);
  return turned(interleaved_gradient(x, y), interleaved_gradient(y, x), interleaved_gradient(~x, y), frame_index, seed);
}

// Bayer's order of 4 x 4 pixels, through the first three dimensions of a (0, 4, 3)-net: any two are stratified over the 16.
vec3 noise_4x4(ivec2 pixel, uint frame_index, uint seed) {
  uint x = uint(pixel.x);
  uint y = uint(pixel.y);
  uint differ = x ^ y;
  uint i = ((differ & 1u) << 3) | ((y & 1u) << 2) | (differ & 2u) | ((y >> 1) & 1u);
  uint sobol = ((i & 1u) * 0x80000000u) ^ (((i >> 1) & 1u) * 0xC0000000u) ^ (((i >> 2) & 1u) * 0xA0000000u) ^
               ((i >> 3) * 0xF0000000u);
  uint middle = 1u << 27;
  return turned((i << 28) + middle, uint(bitfieldReverse(i)) + middle, sobol + middle, frame_index, seed);
}

vec3 noise_white(ivec2 pixel, uint frame_index, uint seed) {
  uint x = hash_uint(uint(pixel.x) + hash_uint(uint(pixel.y) + hash_uint(frame_index + hash_uint(seed))));
  uint y = hash_uint(x ^ 0x9E3779B9u);
  return vec3(unit_float(x), unit_float(y), unit_float(hash_uint(y ^ 0x3C6EF372u)));
}

// --- noise from a table (passes/noise.h): 64 x 64 texels of blue noise ---

ivec2 blue_texel(ivec2 pixel) { return ivec2(pixel.x & 63, pixel.y & 63); }

// One of the three numbers of 10 bits, in units of 2^-32.
uint table_number(uint texel, int i) { return ((texel >> uint(10 * i)) << 22) + (1u << 21); }

vec3 noise_blue(uint texel, uint frame_index, uint seed) {
  return turned(table_number(texel, 0), table_number(texel, 1), table_number(texel, 2), frame_index, seed);
}

// Spatio-temporal: blue in every frame, and over the frames each pixel runs through the first three dimensions of Sobol's sequence (Joe and Kuo
// 2008), scrambled by its own number (a digital shift). The mean of 2^k frames has one of every 2^-k in each dimension, and exchanging
// halves, quarters and so on of a blue pattern leaves more of its blue than turning it.
vec3 noise_stbn(uint texel, uint frame_index, uint seed) {
  uint y = 0u;
  uint z = 0u;
  uint direction_y = 0x80000000u;
  uint direction_z = 0x80000000u;
  uint next_z = 0xC0000000u;
  for (uint bits = frame_index; bits != 0u; bits >>= 1) {
    uint chosen = 0u - (bits & 1u);
    y ^= direction_y & chosen;
    z ^= direction_z & chosen;
    direction_y ^= direction_y >> 1;
    uint after_next = direction_z ^ (direction_z >> 2) ^ next_z;
    direction_z = next_z;
    next_z = after_next;
  }
  return vec3(unit_float(table_number(texel, 0) ^ uint(bitfieldReverse(frame_index)) ^ hash_uint(seed)),
              unit_float(table_number(texel, 1) ^ y ^ hash_uint(seed + 0x9E3779B9u)),
              unit_float(table_number(texel, 2) ^ z ^ hash_uint(seed + 0x3C6EF372u)));
}

// x: rotation of the slices, y: step jitter, z: sector jitter; each uniform in [0, 1), independent of the others.
vec3 sampling_noise(ivec2 pixel, uint frame_index, uint seed) {
#if NOISE_KIND == NOISE_HILBERT_R2
  return noise_hilbert_r2(pixel, frame_index, seed);
#elif NOISE_KIND == NOISE_IGN
  return noise_ign(pixel, frame_index, seed);
#elif NOISE_KIND == NOISE_4X4
  return noise_4x4(pixel, frame_index, seed);
#elif NOISE_KIND == NOISE_BLUE
  return noise_blue(FETCH_NOISE(blue_texel(pixel)), frame_index, seed);
#elif NOISE_KIND == NOISE_STBN
  return noise_stbn(FETCH_NOISE(blue_texel(pixel)), frame_index, seed);
#else
  return noise_white(pixel, frame_index, seed);
#endif
}

// A number of its own for every step of every march; a march is one side of one slice.
int step_index(int march, int step_number, int steps) { return march * steps + step_number; }

// Golden-ratio rotation: neighbours in index are far apart in value.
float rotated(float noise, int index) { return fract(noise + float(index) * GOLDEN); }

#endif
