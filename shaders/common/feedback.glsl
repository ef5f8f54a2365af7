// What keeps feedback from growing. Compiles as GLSL and C++.
#ifndef NF_COMMON_FEEDBACK_GLSL
#define NF_COMMON_FEEDBACK_GLSL

// Of the light that a surface is given, no more than `limit` goes on, its colour kept.
vec3 limit_reflectance(vec3 reflectance, float limit) {
  float most = max(reflectance.x, max(reflectance.y, reflectance.z));
  return most > limit ? reflectance * (limit / most) : reflectance;
}

// Factor on what is fed back, from the loop's gain without it: light fed back per light gathered from, of the last frame. With
// the gain times this below 1, the sum of all bounces is finite.
float feedback_scale(float fed_back, float gathered, float limit) {
  return fed_back > limit * gathered ? limit * gathered / max(fed_back, 1e-20f) : 1.0f;
}

#endif
