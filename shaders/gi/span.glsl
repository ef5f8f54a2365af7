// What a sample of a march stands for (BITMASK_SPAN interval): its surface over the whole step that it was drawn from. Steps
// are wider than most of what is seen is taken to be thick, so samples that stand for their texels alone leave out most of a
// surface, and more of it the fewer they are. Of a surface as wide as the steps or wider, the spans abut and leave
// nothing out. What is narrower than its step is met by a jittered sample with the chance that is its share of the step, and then
// counts for all of the step: the mean is right there, too. Compiles as GLSL and as C++; needs what gi/march.glsl needs.
#ifndef NF_GI_SPAN_GLSL
#define NF_GI_SPAN_GLSL

#include "gi/march.glsl"

// The surface is what the same-information reference takes a texel for (engine/reference/columns.h): a plane with the slope of
// the depths beside it in 1/z, by which planes are affine on the screen. `distance` pixels along the side, in the slice itself
// and not at the texel beside it, 1/z is that of the texel times start + distance slope.
struct Span {
  float start;
  float slope;
  float near;  // ends of the step, pixels along the side
  float far;
};

float depth_beside(ivec2 texel) {
  ivec2 on_screen = clamp(texel, ivec2(0), ivec2(frame.size) - 1);
  float depth = FETCH_DEPTH(on_screen);
  return on_screen == texel ? depth : 0.0f;
}

// By how much 1/z grows in a texel, in shares of it: of the differences to both sides the smaller, as one across an edge is no
// slope; what is missing is infinitely far.
float gentle_slope(float before, float depth, float after) {
  bool back = abs(before - depth) * after < abs(depth - after) * before;
  float beside = back ? before : after;
  return beside > 0.0f ? (back ? before - depth : depth - after) / beside : 0.0f;
}

Span make_span(Side side, Tap tap, float near, float far) {
  vec2 slope = vec2(gentle_slope(depth_beside(tap.texel - ivec2(1, 0)), tap.depth, depth_beside(tap.texel + ivec2(1, 0))),
                    gentle_slope(depth_beside(tap.texel - ivec2(0, 1)), tap.depth, depth_beside(tap.texel + ivec2(0, 1))));
  Span span;
  span.start = 1.0f - dot(slope, tap.offset);
  span.slope = dot(slope, side.direction);
  // Not to the plane's horizon: to a tenth of the texel's 1/z.
  float most = 0.9f / max(abs(span.slope), 1e-9f);
  float texel = dot(tap.offset, side.direction);
  span.near = max(near, texel - most);
  span.far = min(far, texel + most);
  return span;
}

// The ends of a surface turn different ways about the receiver: of one that shows it its front the far end is nearest to V.
// `behind`: of the surface in question, as in span_sine.
bool shows_front(Receiver receiver, Tap tap, Span span, float behind) {
  return tap.depth + behind * span.start > receiver.depth * span.start;
}

// Sine of a point so far behind a point of the span (in units of Slab.along).
float span_sine(Receiver receiver, Side side, Tap tap, Span span, float distance, float behind) {
  // All coordinates times this, as only the direction counts.
  float w = span.start + distance * span.slope;
  float depth = tap.depth;
  float along_v = 0.0f;
  if (GI_BACK_ALONG == BACK_SAMPLE_RAY)
    depth += behind * w;
  else
    along_v = -behind * w;
  float deeper = depth - receiver.depth * w;
  float across = depth * distance;
  float s = deeper * side.s_depth + across * side.s_step + along_v * side.sin_gamma;
  float c = deeper * side.c_depth + across * side.c_step + along_v * side.cos_gamma;
  vec2 beside = across * side.direction * frame.ray_scale;
  vec3 towards = receiver.ray * deeper + vec3(beside.x, beside.y, 0.0f) + along_v * receiver.v;
  return point_sine(receiver, side, s, c, 0.0f, towards);
}

#endif
