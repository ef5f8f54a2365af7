// The picture's GI from small pictures'. ALL_PIXELS: each pixel is a texel of one of them. Else of the texels around it, in each
// small picture, those of the same surface count; where there is none, the one that is least off. Texel q of a small picture
// stands for pixel factor * q + offset, whose own depth and normal are read.
#version 460
#include "common/fetch.glsl"
#include "common/frame.glsl"
#include "common/pack.glsl"
#include "common/view.glsl"
#include "params/grid"
#ifndef ALL_PIXELS
#include "params/resolution"
FETCH_FLOAT_IMAGE(depth);
FETCH_UINT_IMAGE(normal);
#endif

#ifdef HAS_VISIBILITY
uniform texture2DArray visibility_in;
layout(location = VISIBILITY_AT) out float visibility;
#endif
#ifdef HAS_GI
uniform texture2DArray gi_in;
layout(location = GI_AT) out vec4 gi;
#endif
#ifdef HAS_AMBIENT
uniform texture2DArray ambient_in;
layout(location = AMBIENT_AT) out vec4 ambient;
#endif
#ifdef HAS_BENT
uniform texture2DArray bent_in;
layout(location = BENT_AT) out vec4 bent;
#endif

void add_texel(ivec3 texel, float w) {
#ifdef HAS_VISIBILITY
  visibility += w * texelFetch(visibility_in, texel, 0).x;
#endif
#ifdef HAS_GI
  gi += w * texelFetch(gi_in, texel, 0);
#endif
#ifdef HAS_AMBIENT
  ambient += w * texelFetch(ambient_in, texel, 0);
#endif
#ifdef HAS_BENT
  bent += w * texelFetch(bent_in, texel, 0);
#endif
}

#ifdef ALL_PIXELS
// Which small picture has pixel `at` of a block: the order of passes/resolution.cpp.
int layer_2(ivec2 at) { return at.x == at.y ? at.x : 3 - at.x; }
int layer_of(ivec2 at) { return grid.factor == 2 ? layer_2(at) : layer_2(at >> 1) + 4 * layer_2(at & 1); }
#endif

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
#ifdef HAS_VISIBILITY
  visibility = 0.0;
#endif
#ifdef HAS_GI
  gi = vec4(0.0);
#endif
#ifdef HAS_AMBIENT
  ambient = vec4(0.0);
#endif
#ifdef HAS_BENT
  bent = vec4(0.0);
#endif
#ifdef ALL_PIXELS
  add_texel(ivec3(pixel / grid.factor, layer_of(pixel % grid.factor)), 1.0);
#else
  float z = FETCH(depth, pixel);
  vec3 n = unpack_normal(FETCH(normal, pixel));
  vec3 at = view_position(vec2(pixel) + 0.5, z, frame.ray_scale, frame.ray_offset);
  int factor = grid.factor;
  float weights = 0.0, least = 3e38;
  ivec3 best = ivec3(0);
  float weight[8];
  ivec3 texels[8];
  int taps = 4 * grid.layers;
  for (int i = 0; i < 8; ++i) {
    ivec2 offset = i < 4 ? grid.offset0 : grid.offset1;
    vec2 place = vec2(pixel - offset) / float(factor);
    vec2 low = floor(place), share = place - low;
    ivec2 corner = ivec2(i & 1, (i >> 1) & 1);
    ivec2 texel = ivec2(low) + corner;
    vec2 near = mix(1.0 - share, share, vec2(corner));
    ivec2 source = texel * factor + offset;  // its pixel
    bool there = i < taps && all(greaterThanEqual(texel, ivec2(0))) && all(lessThan(source, frame.size));
    source = clamp(source, ivec2(0), frame.size - 1);
    float zs = FETCH(depth, source);
    vec3 from = view_position(vec2(source) + 0.5, zs, frame.ray_scale, frame.ray_offset);
    float off_plane = abs(dot(n, from - at)) / max(z, 1e-6);
    float off_depth = abs(zs - z) / max(z, 1e-6);
    float turned = 1.0 - dot(n, unpack_normal(FETCH(normal, source)));
    float w = near.x * near.y;
    float off = length(vec2(source - pixel)) * 1e-3;
    if (resolution.upsample == 1) {
      w *= exp(-50.0 * off_depth);
      off += off_depth * 50.0;
    } else if (resolution.upsample == 2) {
      w *= exp(-100.0 * off_plane - 8.0 * turned);
      off += off_plane * 100.0 + 8.0 * turned;
    } else {
      w = 0.0;  // the least off is the nearest
    }
    there = there && (zs > 0.0) == (z > 0.0);
    w = there ? w : 0.0;
    // A texel of this very pixel is its own.
    bool own = there && source == pixel;
    if (there && (off < least || own)) {
      least = own ? -1.0 : off;
      best = ivec3(texel, i / 4);
    }
    weight[i] = w;
    texels[i] = ivec3(max(texel, ivec2(0)), i / 4);
    weights += w;
  }
  bool blend = least >= 0.0 && weights > 0.02;
  // With no texel of this kind around (a lone pixel), it stays open and dark.
  if (least > 1e38) {
#ifdef HAS_VISIBILITY
    visibility = 1.0;
#endif
    return;
  }
  if (!blend) add_texel(best, 1.0);
  for (int i = 0; i < (blend ? taps : 0); ++i)
    if (weight[i] > 0.0) add_texel(texels[i], weight[i] / weights);
#endif
}
