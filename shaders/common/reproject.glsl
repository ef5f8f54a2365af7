// Last frame's texels of this frame's points. The including file declares FETCH_FLOAT_IMAGE(previous_depth) and
// FETCH_UINT_IMAGE(previous_normal), and has common/{fetch,frame,pack,view}.glsl and params/reproject.
#ifndef NF_COMMON_REPROJECT_GLSL
#define NF_COMMON_REPROJECT_GLSL

// A point of this frame, view space, and how far (metres) it may have moved by itself, other than by the camera.
struct Point {
  vec3 position;
  vec3 normal;
  float slack;
};

// Where the point at `position` would have been in the last picture had only the camera moved: pixels, without jitter.
vec2 camera_velocity(vec2 pixel, vec3 position) {
  vec4 clip = frame.previous_clip_from_world * (frame.world_from_view * vec4(position, 1.0));
  vec2 ndc = clip.xy / clip.w;
  return pixel - reproject.jitter - (ndc * 0.5 + 0.5) * vec2(frame.size);
}

// The same for a point infinitely far away in this direction.
vec2 background_velocity(vec2 pixel, vec3 direction) {
  vec4 clip = frame.previous_clip_from_world * vec4(mat3(frame.world_from_view) * direction, 0.0);
  return clip.w > 0.0 ? pixel - reproject.jitter - (clip.xy / clip.w * 0.5 + 0.5) * vec2(frame.size) : vec2(0.0);
}

Point make_point(vec2 pixel, float depth, vec3 normal, vec2 velocity) {
  Point point;
  point.position = view_position(pixel, depth, frame.ray_scale, frame.ray_offset);
  point.normal = normal;
  point.slack = length(velocity - camera_velocity(pixel, point.position)) * depth * abs(frame.ray_scale.y);
  return point;
}

// Whether the last frame's texel shows the same surface: near the point's plane (as a share of its depth), turned alike.
bool same_surface(Point point, ivec2 texel, float depth_tolerance, float least_cosine) {
  if (any(lessThan(texel, ivec2(0))) || any(greaterThanEqual(texel, frame.size))) return false;
  float z = FETCH(previous_depth, texel);
  vec3 before = view_position(vec2(texel) + 0.5, z, reproject.previous_ray_scale, reproject.previous_ray_offset);
  before = (reproject.view_from_previous_view * vec4(before, 1.0)).xyz;
  vec3 normal = mat3(reproject.view_from_previous_view) * unpack_normal(FETCH(previous_normal, texel));
  float away = abs(dot(point.normal, before - point.position));
  return z > 0.0 && away <= depth_tolerance * -point.position.z + point.slack && dot(normal, point.normal) >= least_cosine;
}

#endif
