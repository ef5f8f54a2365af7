// Points in the hemisphere over a receiver, and what the depth buffer says about them: what ssao, ssdo and raymarch share.
// Compiles as GLSL and as C++; needs what gi/march.glsl needs.
#ifndef NF_GI_HEMISPHERE_GLSL
#define NF_GI_HEMISPHERE_GLSL

#include "gi/march.glsl"

// The surface seen in the texel where a point lies.
struct Probe {
  ivec2 texel;
  float depth;   // 0: background, or off the screen
  vec3 towards;  // from the receiver to the surface, metres
  float behind;  // depth of the point beyond the surface, metres
};

Probe probe_at(Receiver receiver, vec3 offset) {
  vec3 position = receiver.ray * receiver.depth + offset;
  float axial = max(-position.z, 1e-6f);
  vec2 pixel = (vec2(position.x, position.y) / axial - frame.ray_offset) / frame.ray_scale;
  Probe probe;
  probe.texel = ivec2(floor(clamp(pixel, vec2(-1.0f), vec2(frame.size))));
  bool on_screen = position.z < 0.0f && probe.texel.x >= 0 && probe.texel.y >= 0 && probe.texel.x < frame.size.x &&
                   probe.texel.y < frame.size.y;
  if (!on_screen) probe.texel = receiver.pixel;
  probe.depth = on_screen ? FETCH_DEPTH(probe.texel) : 0.0f;
  vec2 beside = vec2(probe.texel - receiver.pixel) * frame.ray_scale * probe.depth;
  probe.towards = receiver.ray * (probe.depth - receiver.depth) + vec3(beside.x, beside.y, 0.0f);
  probe.behind = axial - probe.depth;
  return probe;
}

bool rises(Receiver receiver, Probe probe) { return rises_over(receiver.normal, probe.towards); }

// Depth of what is taken as solid behind a surface (gi.thickness_mode), as the bitmasks have it: along the sample's own view
// ray or the receiver's.
float solid_depth(Receiver receiver, Probe probe) {
  if (GI_THICKNESS_MODE == THICKNESS_INFINITE) return 1e30f;
  float thickness = GI_THICKNESS_MODE == THICKNESS_LINEAR ? gi.thickness * probe.depth : gi.thickness;
  vec2 beside = vec2(probe.texel - receiver.pixel) * frame.ray_scale;
  vec3 ray = GI_BACK_ALONG == BACK_SAMPLE_RAY ? receiver.ray + vec3(beside.x, beside.y, 0.0f) : receiver.ray;
  return thickness * inversesqrt(dot(ray, ray));
}

// Whether a point in the direction `towards` is within what lies behind the surface.
bool is_inside(Receiver receiver, Probe probe, vec3 towards) {
  if (GI_THICKNESS_MODE == THICKNESS_ANGULAR) {
    float along = dot(probe.towards, towards);
    float near_enough = cos(radians(gi.thickness_angle));
    return probe.behind > 0.0f && along > 0.0f &&
           along * along > near_enough * near_enough * dot(probe.towards, probe.towards) * dot(towards, towards);
  }
  return probe.behind > 0.0f && probe.behind < solid_depth(receiver, probe);
}

// Whether the texel's surface shows its front to the receiver.
bool faces(Probe probe) { return dot(unpack_normal_octahedron(FETCH_NORMAL(probe.texel)), probe.towards) < 0.0f; }

// --- directions ---

// A direction given about +z, turned to be about the unit vector n (Duff et al. 2017).
vec3 about(vec3 n, vec3 d) {
  float s = n.z >= 0.0f ? 1.0f : -1.0f;
  float a = -1.0f / (s + n.z);
  float b = n.x * n.y * a;
  vec3 t = vec3(1.0f + s * n.x * n.x * a, s * b, -s * n.x);
  vec3 u = vec3(b, s + n.y * n.y * a, -n.y);
  return t * d.x + u * d.y + n * d.z;
}

// Point i of the sequence R3 (Roberts 2018), turned by the pixel's noise: azimuth, height, length.
vec3 turned_point(vec3 noise, int i) {
  return fract(noise + float(i) * vec3(0.81917251f, 0.67104361f, 0.54970048f));
}

vec3 cosine_direction(vec3 n, float azimuth, float u) {
  float phi = 2.0f * PI * azimuth;
  float r = sqrt(u);
  return about(n, vec3(r * cos(phi), r * sin(phi), sqrt(1.0f - u)));
}

vec3 uniform_direction(vec3 n, float azimuth, float z) {
  float phi = 2.0f * PI * azimuth;
  float r = sqrt(max(1.0f - z * z, 0.0f));
  return about(n, vec3(r * cos(phi), r * sin(phi), z));
}

// --- light from a sender ---

// cos cos' / (d^2 + area / pi): times the area, pi times the form factor of a disc as seen from a point over it, and nowhere
// singular; so the picture is the same at any scale. Not positive when a side is turned away.
float sender_share(Receiver receiver, Probe probe, vec3 sender_normal, float area) {
  float distance2 = dot(probe.towards, probe.towards) + 1e-30f;
  float to_sender = dot(receiver.normal, probe.towards);
  float to_receiver = -dot(sender_normal, probe.towards);
  if (to_sender <= 0.0f || to_receiver <= 0.0f) return 0.0f;
  return to_sender * to_receiver / (distance2 * (distance2 + area / PI));
}

// cos cos' / d^2 as printed; d is at least `nearest`.
float sender_share_printed(Receiver receiver, Probe probe, vec3 sender_normal, float nearest) {
  float distance2 = dot(probe.towards, probe.towards) + 1e-30f;
  float to_sender = dot(receiver.normal, probe.towards);
  float to_receiver = -dot(sender_normal, probe.towards);
  if (to_sender <= 0.0f || to_receiver <= 0.0f) return 0.0f;
  return to_sender * to_receiver / (distance2 * max(distance2, nearest * nearest));
}

#endif
