// Colour of light as filters see it: luminance, YCoCg, and tests for what is no number. Compiles as GLSL and C++.
#ifndef NF_COMMON_COLOR_GLSL
#define NF_COMMON_COLOR_GLSL

// Rec.709.
float luminance(vec3 c) { return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z; }

// False for NaN and infinities, whatever the compiler makes of isnan().
bool is_number(float x) { return abs(x) <= 3e38f; }
bool is_number(vec3 v) { return is_number(v.x) && is_number(v.y) && is_number(v.z); }

vec3 ycocg_from_rgb(vec3 c) {
  return vec3(0.25f * c.x + 0.5f * c.y + 0.25f * c.z, 0.5f * c.x - 0.5f * c.z, -0.25f * c.x + 0.5f * c.y - 0.25f * c.z);
}
vec3 rgb_from_ycocg(vec3 c) { return vec3(c.x + c.y - c.z, c.x + c.z, c.x - c.y - c.z); }

#endif
