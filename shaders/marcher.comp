// Random rays through the columns of a depth buffer (engine/reference/same_information.h says the model). Everything is in
// units of the receiver's depth z0: along a ray 1/z is (1 - k q) / z0, with q = s / z, and differences from the receiver's
// plane are taken before they are scaled, which keeps single precision enough.
#version 460
#include "params/marcher"

layout(local_size_x = 8, local_size_y = 8) in;

struct Texel {
  float w;  // 1 / depth, 0 = none
  vec2 slope;
  vec3 normal, radiance;
};
layout(scalar) readonly buffer texel_table { Texel rows[]; } texels;
layout(scalar) readonly buffer sky_table { vec3 rows[]; } sky;
uniform writeonly image2D light;    // sums of radiance
uniform writeonly image2D open;     // of open directions, and of openness
uniform writeonly image2D ambient;  // of the sky's radiance in them

const float ENDLESS = 1e30, PI = 3.14159265;
const float ROUNDING = 4e-6;  // nearer than this share a ray is on a plane, not behind
const uint DISC = 2, BALL_FALLOFF = 1;
const uint LINEAR = 1, INFINITE = 2;

uint pcg(uint x) {
  x = x * 747796405u + 2891336453u;
  x = ((x >> ((x >> 28) + 4u)) ^ x) * 277803737u;
  return (x >> 22) ^ x;
}
float unit(uint bits) { return float(bits >> 8) * (1.0 / 16777216.0); }

// Nested uniform scrambling of the bits (Laine and Karras 2011, constants of Burley 2020).
uint scramble(uint x, uint seed) {
  x = bitfieldReverse(x) + seed;
  x ^= x * 0x6c50b47cu;
  x ^= x * 0xb82f1e52u;
  x ^= x * 0xc7afe638u;
  x ^= x * 0x8d22f6e6u;
  return bitfieldReverse(x);
}
uint sobol_second(uint index) {
  uint x = 0, v = 1u << 31;
  for (; index != 0; index >>= 1, v ^= v >> 1)
    if ((index & 1) != 0) x ^= v;
  return x;
}
vec2 random(uint key, uint index) {
  if (marcher.independent != 0) {
    uint x = pcg(key ^ pcg(index));
    return vec2(unit(x), unit(pcg(x ^ 0x68bc21ebu)));
  }
  index = scramble(index, key);
  uint a = pcg(key), b = pcg(a);
  return vec2(unit(scramble(bitfieldReverse(index), a)), unit(scramble(sobol_second(index), b)));
}

vec3 local_direction(vec2 u) {
  float phi = 2.0 * PI * u.y;
  float z = marcher.uniform_directions != 0 ? u.x : sqrt(1.0 - u.x);
  return vec3(sqrt(max(0.0, 1.0 - z * z)) * vec2(cos(phi), sin(phi)), z);
}
mat3 frame_about(vec3 n) {
  vec3 side = normalize(abs(n.x) > 0.6 ? cross(n, vec3(0, 1, 0)) : cross(n, vec3(1, 0, 0)));
  return mat3(side, cross(n, side), n);
}

vec3 sky_radiance(vec3 d) {
  float u = 0.5 + (atan(d.z, d.x) + marcher.sky_rotation) / (2.0 * PI), v = 0.5 - asin(clamp(d.y, -1.0, 1.0)) / PI;
  vec2 at = vec2(u, v) * vec2(marcher.sky_size) - 0.5, f = at - floor(at);
  ivec2 low = ivec2(floor(at));
  vec3 sum = vec3(0.0);
  for (int i = 0; i < 4; ++i) {
    ivec2 step = ivec2(i & 1, i >> 1);
    int x = (low.x + step.x) % marcher.sky_size.x, y = clamp(low.y + step.y, 0, marcher.sky_size.y - 1);
    if (x < 0) x += marcher.sky_size.x;
    vec2 weight = mix(1.0 - f, f, vec2(step));
    sum += weight.x * weight.y * sky.rows[y * marcher.sky_size.x + x];
  }
  return sum;
}

struct Walk {
  vec2 start, velocity;  // pixels, pixels a q
  float w0, z0, k;
};

// How far the ray is behind the front of a column, in metres of depth, or -1: `off` is from the column's centre.
float behind(Walk walk, Texel t, float rise, vec2 off, float q) {
  float front = max(1.0 + rise + walk.z0 * dot(t.slope, off), 1e-9);
  float gap = rise + walk.z0 * dot(t.slope, off) + walk.k * q, ray = 1.0 - walk.k * q;
  if (gap < ROUNDING * front) return -1.0;
  return ray > 0.0 ? walk.z0 * gap / (ray * front) : ENDLESS;
}

float crossing(Walk walk, Texel t, float rise, vec2 center) {
  float at_zero = rise + walk.z0 * dot(t.slope, walk.start - center);
  float rate = walk.z0 * dot(t.slope, walk.velocity) + walk.k;
  return rate != 0.0 ? max(-at_zero / rate, 0.0) : 0.0;
}

// The q in [q0, q1], the ray's part over this texel, at which it is stopped, or -1.
float enter(Walk walk, Texel t, vec2 center, float q0, float q1) {
  float rise = walk.z0 * (t.w - walk.w0);
  float first = behind(walk, t, rise, walk.start + q0 * walk.velocity - center, q0);
  float then = behind(walk, t, rise, walk.start + q1 * walk.velocity - center, q1);
  if (first < 0.0 && then < 0.0) return -1.0;
  vec2 tangents = center * marcher.scale + marcher.offset;
  float through = ENDLESS;
  if (marcher.thickness_mode != INFINITE)
    through = marcher.thickness * (marcher.thickness_mode == LINEAR ? 1.0 / t.w : 1.0) / sqrt(1.0 + dot(tangents, tangents));
  if (first < 0.0) return crossing(walk, t, rise, center);
  if (first <= through) return q0;
  if (then > through) return -1.0;
  return then >= 0.0 ? q1 : crossing(walk, t, rise, center);
}

// The texel that stops the ray, or -1, and how far away.
int march(ivec2 pixel, float w0, vec3 d, out float distance) {
  Walk walk;
  walk.w0 = w0, walk.z0 = 1.0 / w0, walk.k = -d.z;
  walk.start = vec2(pixel) + 0.5;
  vec2 per_q = d.xy - walk.k * (walk.start * marcher.scale + marcher.offset);
  walk.velocity = per_q / marcher.scale;
  float last = walk.k > 0.0 ? 1.0 / walk.k : walk.k < 0.0 ? (1.0 - walk.z0 / marcher.near) / walk.k : ENDLESS;
  if (marcher.radius > 0.0) {
    float end = walk.z0 + marcher.radius * walk.k;
    if (marcher.radius_mode == DISC) last = min(last, marcher.radius / (walk.z0 * max(length(per_q), 1e-20)));
    else if (end > 0.0) last = min(last, marcher.radius / end);
  }
  ivec2 cell = pixel, step = ivec2(walk.velocity.x > 0.0 ? 1 : -1, walk.velocity.y > 0.0 ? 1 : -1);
  float q0 = 0.0;
  distance = 0.0;
  int most = marcher.size.x + marcher.size.y + 2;
  for (int i = 0; i < most && q0 < last; ++i) {
    vec2 next = (vec2(cell) + vec2(max(step, ivec2(0))) - walk.start) / walk.velocity;
    if (walk.velocity.x == 0.0) next.x = ENDLESS;
    if (walk.velocity.y == 0.0) next.y = ENDLESS;
    float q1 = min(min(next.x, next.y), last);
    int row = cell.y * marcher.size.x + cell.x;
    Texel t = texels.rows[row];
    if (i > 0 && t.w > 0.0) {  // the receiver's own texel is the receiver
      float hit = enter(walk, t, vec2(cell) + 0.5, q0, q1);
      if (hit >= 0.0) {
        distance = hit * walk.z0 / max(1.0 - walk.k * hit, 1e-12);
        return row;
      }
    }
    if (q1 >= last) break;
    if (next.x < next.y) cell.x += step.x;
    else cell.y += step.y;
    if (cell.x < 0 || cell.y < 0 || cell.x >= marcher.size.x || cell.y >= marcher.size.y) break;
    q0 = q1;
  }
  return -1;
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (pixel.x >= marcher.size.x || pixel.y >= marcher.size.y) return;
  int own = pixel.y * marcher.size.x + pixel.x;
  Texel here = texels.rows[own];
  vec3 light_sum = vec3(0.0), sky_sum = vec3(0.0);
  vec4 open_sum = vec4(0.0, 0.0, 0.0, here.w > 0.0 ? 0.0 : float(marcher.count));
  uint key = pcg(uint(own) ^ pcg(marcher.key));
  mat3 frame = here.w > 0.0 ? frame_about(normalize(here.normal)) : mat3(1.0);
  for (uint i = 0; here.w > 0.0 && i < marcher.count; ++i) {
    vec3 local = local_direction(random(key, marcher.first + i));
    // A uniform direction is worth twice its cosine.
    float weight = marcher.uniform_directions != 0 ? 2.0 * local.z : 1.0;
    vec3 direction = frame * local;
    float distance;
    int stop = march(pixel, here.w, mat3(marcher.view_from_world) * direction, distance);
    float openness = 1.0;
    if (stop >= 0) {
      openness = 0.0;
      if (marcher.radius_mode == BALL_FALLOFF && marcher.radius > 0.0)
        openness = 1.0 - clamp((marcher.radius - distance) / max(marcher.falloff * marcher.radius, 1e-6), 0.0, 1.0);
      Texel at = texels.rows[stop];
      if (marcher.one_sided == 0 || dot(at.normal, direction) < 0.0) light_sum += at.radiance * (weight * (1.0 - openness));
    }
    open_sum += weight * openness * vec4(direction, 1.0);
    if (marcher.sky_size.x > 0 && openness > 0.0) sky_sum += weight * openness * sky_radiance(direction);
  }
  imageStore(light, pixel, vec4(light_sum, 0.0));
  imageStore(open, pixel, open_sum);
  imageStore(ambient, pixel, vec4(sky_sum, 0.0));
}
