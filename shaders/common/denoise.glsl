// Weights and texels of the spatial filter. Compiles as GLSL and C++.
#ifndef NF_COMMON_DENOISE_GLSL
#define NF_COMMON_DENOISE_GLSL

// Variance of a mean over too few frames: brightness then says nothing.
const float NO_VARIANCE = 1e30f;
// No octahedral normal packs to -32768 twice.
const uint NO_BENT = 0x80008000u;

// Visibility in [-1, 3) in steps of 2^-14, because an unbiased estimate may lie outside [0, 1]; the variance keeps a
// float's upper half.
uint pack_state(float visibility, float variance) {
  uint fixed_point = uint(clamp((visibility + 1.0f) * 16384.0f + 0.5f, 0.0f, 65535.0f));
  return fixed_point | (floatBitsToUint(variance) & 0xFFFF0000u);
}
float unpack_visibility(uint bits) { return float(bits & 0xFFFFu) * (1.0f / 16384.0f) - 1.0f; }
float unpack_variance(uint bits) { return uintBitsToFloat(bits & 0xFFFF0000u); }

// What a tap's weight falls off with; each is a number of e-foldings.
struct Edges {
  float plane;  // per metre away from the centre's plane
  float turn;   // per unit of 1 - cosine between the normals
};

Edges make_edges(float depth, float depth_tolerance, float normal_sharpness) {
  Edges edges;
  edges.plane = 1.0f / max(depth_tolerance * depth, 1e-6f);
  edges.turn = normal_sharpness;
  return edges;
}

// `variance` is that of the difference in brightness: of both pixels together. With the centre's alone a dark pixel without
// variance would refuse light that its bright neighbour gives away, and the picture would darken.
float edge_weight(Edges edges, float plane_distance, float cosine, float brightness_difference, float variance, float tolerance) {
  float off = tolerance > 0.0f ? abs(brightness_difference) * inversesqrt(variance + 1e-12f) / tolerance : 0.0f;
  return exp(-(edges.plane * abs(plane_distance) + edges.turn * (1.0f - cosine) + off));
}

#endif
