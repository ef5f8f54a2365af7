// Bounds of loops that uniforms alone decide.
#ifndef NF_COMMON_BOUND_GLSL
#define NF_COMMON_BOUND_GLSL

// n, by a sum that seems to depend on the pixel; z is one of its numbers and not negative. Mesa 22.3's lavapipe puts the
// values of uniforms into conditions and ends of loops that depend on nothing else. Where that makes half of a shader go, or more of
// it, the shader is compiled anew in every draw and what was made is kept: megabytes a frame. (By a choice, as z > 0 ? n : 0,
// three of them in one shader crash its compiler.)
int own_bound(int n, float z) { return n + int(floatBitsToUint(z) >> 31); }
uint own_bound(uint n, float z) { return n + (floatBitsToUint(z) >> 31); }

#endif
