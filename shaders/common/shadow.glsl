// Geometry of shadow maps. Compiles as GLSL and C++.
#ifndef NF_COMMON_SHADOW_GLSL
#define NF_COMMON_SHADOW_GLSL
#ifndef INOUT
#define INOUT(type) inout type
#endif

// Unit vectors with cross(right, down) = axis (Duff et al. 2017, "Building an Orthonormal Basis, Revisited"). As
// map_axes of passes/shadow.cpp.
void map_axes(vec3 axis, INOUT(vec3) right, INOUT(vec3) down) {
  float s = axis.z < 0.0f ? -1.0f : 1.0f;
  float a = -1.0f / (s + axis.z);
  float b = axis.x * axis.y * a;
  right = vec3(1.0f + s * axis.x * axis.x * a, s * b, -s * axis.x);
  down = vec3(b, s + axis.y * axis.y * a, -axis.y);
}

// How far, in metres, a plane has to be moved along its normal so that none of the 2 x 2 texels about a point of it
// shadows it: over a texel's diagonal its depth changes by sqrt(2) tan(angle), of which the normal sees the cosine.
float normal_offset(float texel, float n_l) { return 1.41421356f * texel * sqrt(max(1.0f - n_l * n_l, 0.0f)); }

// Which of a point light's six tiles a direction falls in: +x -x +y -y +z -z.
int face_of(vec3 d, INOUT(vec3) axis) {
  float x = abs(d.x);
  float y = abs(d.y);
  float z = abs(d.z);
  if (x >= y && x >= z) {
    axis = vec3(d.x < 0.0f ? -1.0f : 1.0f, 0.0f, 0.0f);
    return d.x < 0.0f ? 1 : 0;
  }
  if (y >= z) {
    axis = vec3(0.0f, d.y < 0.0f ? -1.0f : 1.0f, 0.0f);
    return d.y < 0.0f ? 3 : 2;
  }
  axis = vec3(0.0f, 0.0f, d.z < 0.0f ? -1.0f : 1.0f);
  return d.z < 0.0f ? 5 : 4;
}

#endif
