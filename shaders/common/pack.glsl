// Packed texels for R32UI images: octahedral normals (2 x 16 bit snorm) and RGB9E5 radiance, with shifts only, because
// formatted loads cost several times as much on the software device. The text compiles as GLSL and as C++.
#ifndef NF_COMMON_PACK_GLSL
#define NF_COMMON_PACK_GLSL

float fold_sign(float x) { return x < 0.0f ? -1.0f : 1.0f; }

uint snorm16(float x) { return uint(int(floor(clamp(x, -1.0f, 1.0f) * 32767.0f + 0.5f))) & 0xFFFFu; }

// Meyer et al. 2010, "On floating-point normal vectors". The normal need not be unit.
uint pack_normal(vec3 n) {
  float scale = 1.0f / (abs(n.x) + abs(n.y) + abs(n.z));
  float x = n.x * scale;
  float y = n.y * scale;
  if (n.z < 0.0f) {
    float folded = (1.0f - abs(y)) * fold_sign(x);
    y = (1.0f - abs(x)) * fold_sign(y);
    x = folded;
  }
  return snorm16(x) | (snorm16(y) << 16);
}

// On the octahedron, not on the sphere: enough where only the direction or a sign counts.
vec3 unpack_normal_octahedron(uint bits) {
  float x = float(int(bits << 16) >> 16) * (1.0f / 32767.0f);
  float y = float(int(bits) >> 16) * (1.0f / 32767.0f);
  float z = 1.0f - abs(x) - abs(y);
  float fold = max(-z, 0.0f);
  return vec3(x - fold * fold_sign(x), y - fold * fold_sign(y), z);
}

vec3 unpack_normal(uint bits) { return normalize(unpack_normal_octahedron(bits)); }

const float RGB9E5_MAX = 65408.0f;

// Written so that NaN becomes 0.
float rgb9e5_clamp(float x) { return x > 0.0f ? min(x, RGB9E5_MAX) : 0.0f; }

// EXT_texture_shared_exponent: bias 15, 9 mantissa bits.
uint pack_rgb9e5(vec3 color) {
  vec3 c = vec3(rgb9e5_clamp(color.x), rgb9e5_clamp(color.y), rgb9e5_clamp(color.z));
  float largest = max(c.x, max(c.y, c.z));
  int exponent = max(int(floatBitsToUint(largest) >> 23) - 127, -16) + 16;
  float scale = uintBitsToFloat(uint(127 + 24 - exponent) << 23);
  // The largest mantissa may round up to 512.
  if (largest * scale + 0.5f >= 512.0f) {
    exponent += 1;
    scale *= 0.5f;
  }
  return uint(c.x * scale + 0.5f) | (uint(c.y * scale + 0.5f) << 9) | (uint(c.z * scale + 0.5f) << 18) |
         (uint(exponent) << 27);
}

vec3 unpack_rgb9e5(uint bits) {
  float scale = uintBitsToFloat(((bits >> 27) + uint(127 - 24)) << 23);
  return vec3(float(bits & 511u), float((bits >> 9) & 511u), float((bits >> 18) & 511u)) * scale;
}

#endif
