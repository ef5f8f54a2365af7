// Where surfaces have moved, appeared or gone since the last frame, other than by the camera's motion: a texel for 4x4 pixels.
// What the camera's motion alone uncovers or hides is none of that: it is there in both frames.
#version 460
#include "common/bound.glsl"
#include "common/fetch.glsl"
#include "common/frame.glsl"
#include "common/pack.glsl"
#include "common/view.glsl"
#include "params/reproject"

FETCH_FLOAT_IMAGE(depth);
FETCH_UINT_IMAGE(normal);
FETCH_FLOAT_IMAGE(previous_depth);
FETCH_UINT_IMAGE(previous_normal);
#include "common/reproject.glsl"
uniform texture2D velocity;
layout(location = 0) out vec2 changes;  // pixels that it has moved, mean of the 16; depth of the nearest that has

// What is not where it was and has not been seen to move.
const float GONE = 64.0;

bool inside(ivec2 texel) { return all(greaterThanEqual(texel, ivec2(0))) && all(lessThan(texel, frame.size)); }

float depth_at(bool before, ivec2 texel) {
  ivec2 q = clamp(texel, ivec2(0), frame.size - 1);
  float z = before ? FETCH(previous_depth, q) : FETCH(depth, q);
  return z > 0.0 ? z : 1e30;
}

// Whether the other picture shows nothing of a surface at the point: of 3x3 pixels all are further away, and none is on its plane
// (of a floor that ends there, a row of pixels may come and go). Point and normal are in that picture's view space.
bool passed_by(bool before, vec3 point, vec3 normal, ivec2 texel, vec2 ray_scale, vec2 ray_offset) {
  bool free = true;
  for (int i = 0; i < 9 && free; ++i) {
    ivec2 q = texel + ivec2(i % 3, i / 3) - ivec2(1);
    float z = depth_at(before, q);
    float off_plane = abs(dot(normal, view_position(vec2(q) + 0.5, z, ray_scale, ray_offset) - point));
    free = z > -1.02 * point.z && off_plane > -0.02 * point.z;
  }
  return free;
}

void main() {
  ivec2 first = ivec2(gl_FragCoord.xy) * 4;
  mat3 turn = mat3(reproject.view_from_previous_view);
  vec3 shift = reproject.view_from_previous_view[3].xyz;
  float moving = 0.0, fastest = 0.0, gone = 0.0, nearest = 3e38;
  int count = own_bound(16 * int(reproject.previous_depth_valid & reproject.previous_normal_valid), FETCH(depth, first));
  for (int i = 0; i < count; ++i) {
    ivec2 pixel = min(first + ivec2(i & 3, i >> 2), frame.size - 1);
    vec2 middle = vec2(pixel) + 0.5;
    float z = FETCH(depth, pixel);
    if (z > 0.0) {
      vec3 here = view_position(middle, z, frame.ray_scale, frame.ray_offset);
      float by_itself = length(texelFetch(velocity, pixel, 0).xy - camera_velocity(middle, here));
      vec3 was = transpose(turn) * (here - shift);
      ivec2 there = ivec2(floor(pixel_of(was, reproject.previous_ray_scale, reproject.previous_ray_offset)));
      if (by_itself > 0.05) {
        moving += min(by_itself, GONE);
        fastest = max(fastest, min(by_itself, GONE));
        nearest = min(nearest, z);
      } else if (was.z < 0.0 && inside(there) && depth_at(true, there) > -1.02 * was.z) {
        vec3 n = transpose(turn) * unpack_normal(FETCH(normal, pixel));
        if (passed_by(true, was, n, there, reproject.previous_ray_scale, reproject.previous_ray_offset)) {
          gone += 1.0;
          nearest = min(nearest, z);
        }
      }
    }
    float before = FETCH(previous_depth, pixel);
    if (before > 0.0) {
      vec3 was = view_position(middle, before, reproject.previous_ray_scale, reproject.previous_ray_offset);
      vec3 here = turn * was + shift;
      ivec2 there = ivec2(floor(pixel_of(here, frame.ray_scale, frame.ray_offset)));
      if (here.z < 0.0 && inside(there) && depth_at(false, there) > -1.02 * here.z) {
        vec3 n = turn * unpack_normal(FETCH(previous_normal, pixel));
        if (passed_by(false, here, n, there, frame.ray_scale, frame.ray_offset)) {
          gone += 1.0;
          nearest = min(nearest, before);
        }
      }
    }
  }
  // Where something moves, what is gone has moved as far.
  moving += min(gone, 16.0) * (fastest > 0.0 ? fastest : GONE);
  changes = vec2(min(moving / 16.0, GONE), nearest < 3e38 ? nearest : 0.0);
}
