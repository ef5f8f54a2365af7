// Average of 4 x 4 pixels, the period of the 4x4 noise, of what a technique gathered. BLUR_EDGES: of the receiver's own surface
// only (near its tangent plane, its normal within 37 degrees).
#version 460
#include "common/fetch.glsl"
#include "common/frame.glsl"
#include "common/pack.glsl"
#include "common/view.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

FETCH_FLOAT_IMAGE(depth);
uniform texture2D raw_visibility;
uniform writeonly image2D visibility;
#if BLUR_EDGES
FETCH_UINT_IMAGE(normal);
#endif
#if BLUR_LIGHT
uniform texture2D raw_light;
uniform writeonly image2D light;
#endif
#if BLUR_AMBIENT
uniform texture2D raw_ambient;
uniform writeonly image2D ambient;
#endif

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (pixel.x >= frame.size.x || pixel.y >= frame.size.y) return;
  float own_depth = FETCH(depth, pixel);
#if BLUR_EDGES
  vec3 own_normal = unpack_normal(FETCH(normal, pixel));
  vec3 own = view_position(vec2(pixel) + 0.5, own_depth, frame.ray_scale, frame.ray_offset);
#endif
  float weights = 0.0;
  float open = 0.0;
  vec3 gi = vec3(0.0);
  vec3 sky = vec3(0.0);
  for (int i = 0; i < 16; ++i) {
    ivec2 texel = clamp(pixel + ivec2(i & 3, i >> 2) - 2, ivec2(0), frame.size - 1);
    float depth_there = FETCH(depth, texel);
    float weight = own_depth > 0.0 && depth_there > 0.0 ? 1.0 : 0.0;
#if BLUR_EDGES
    vec3 apart = view_position(vec2(texel) + 0.5, depth_there, frame.ray_scale, frame.ray_offset) - own;
    bool near = abs(dot(apart, own_normal)) < 0.01 * own_depth;
    weight *= near && dot(unpack_normal(FETCH(normal, texel)), own_normal) > 0.8 ? 1.0 : 0.0;
#endif
    // The pixel itself always counts.
    if (texel == pixel) weight = 1.0;
    weights += weight;
    open += weight * texelFetch(raw_visibility, texel, 0).x;
#if BLUR_LIGHT
    gi += weight * texelFetch(raw_light, texel, 0).rgb;
#endif
#if BLUR_AMBIENT
    sky += weight * texelFetch(raw_ambient, texel, 0).rgb;
#endif
  }
  imageStore(visibility, pixel, vec4(open / weights));
#if BLUR_LIGHT
  imageStore(light, pixel, vec4(gi / weights, 1.0));
#endif
#if BLUR_AMBIENT
  imageStore(ambient, pixel, vec4(sky / weights, 1.0));
#endif
}
