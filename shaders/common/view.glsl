// View space (right-handed, looking down -Z) from pixel positions (integer + 0.5, y down) and linear depth (metres along the
// axis), and back. With tx, ty the tangents of the half field of view: ray_scale = (2 tx / w, -2 ty / h), ray_offset = (-tx, ty).
#ifndef NF_COMMON_VIEW_GLSL
#define NF_COMMON_VIEW_GLSL

// The point at depth 1 under the pixel.
vec3 view_ray(vec2 pixel, vec2 ray_scale, vec2 ray_offset) {
  vec2 tangents = pixel * ray_scale + ray_offset;
  return vec3(tangents.x, tangents.y, -1.0f);
}

vec3 view_position(vec2 pixel, float depth, vec2 ray_scale, vec2 ray_offset) {
  return view_ray(pixel, ray_scale, ray_offset) * depth;
}

vec2 pixel_of(vec3 position, vec2 ray_scale, vec2 ray_offset) {
  return (vec2(position.x, position.y) / -position.z - ray_offset) / ray_scale;
}

// Whether what lies `towards` rises over a surface's tangent plane. What lies in it, the surface itself first of all, does not, wherever
// in its texel a point falls; so no bias is needed. 0.002: rounding of normals and depths.
bool rises_over(vec3 normal, vec3 towards) {
  float height = dot(towards, normal);
  return height > 0.0f && height * height > 4e-6f * dot(towards, towards);
}

#endif
