// The geometry and measure of a slice: the plane through the receiver spanned by V (unit, towards the eye) and a direction
// d in the screen. Angles theta run from the projected normal n_p, positive towards the slice's tangent on the side of +d;
// gamma is the angle of V. Assumes n.V > 0. The text compiles as GLSL and as C++ (tests/glsl_twin.h).
#ifndef NF_COMMON_SLICE_GLSL
#define NF_COMMON_SLICE_GLSL

const float PI = 3.14159265358979f;
const float HALF_PI = 1.57079632679490f;

struct Slice {
  vec3 tangent;     // unit, in the slice, perpendicular to n_p, on the side of +d
  vec3 normal;      // n_p / |n_p|
  float n_length;   // |n_p|, length of the normal's projection onto the slice
  float cos_gamma;
  float sin_gamma;
};

Slice make_slice(vec3 v, vec3 normal, vec3 direction) {
  vec3 across = normalize(direction - v * dot(direction, v));
  float along_v = dot(normal, v);
  float along_across = dot(normal, across);
  Slice slice;
  slice.n_length = sqrt(along_v * along_v + along_across * along_across);
  slice.cos_gamma = along_v / slice.n_length;
  slice.sin_gamma = -along_across / slice.n_length;
  slice.tangent = slice.sin_gamma * v + slice.cos_gamma * across;
  slice.normal = slice.cos_gamma * v - slice.sin_gamma * across;
  return slice;
}

// The slice as seen from its other side: +d becomes -d.
Slice mirror(Slice slice) {
  slice.tangent = -slice.tangent;
  slice.sin_gamma = -slice.sin_gamma;
  return slice;
}

// A normal that faces the eye; interpolated and mapped normals may not, and gamma would leave [-pi/2, pi/2].
vec3 facing_normal(vec3 normal, vec3 v) {
  float lack = max(1e-3f - dot(normal, v), 0.0f);
  return normalize(normal + v * lack);
}

// --- the measure ---
// Within a slice the projected solid angle has the density cos(theta) |sin(theta - gamma)|; with s = sin(theta) and
// K(s) = sin(theta) cos(theta) + theta its integral needs no angle (Visibility Bitmask, eq 3, with the |sin| it lacks).

float slice_k_exact(float s) {
  s = clamp(s, -1.0f, 1.0f);
  return s * sqrt(1.0f - s * s) + asin(s);
}

// Odd polynomial with K(1) = pi/2 exactly; the CDF made of it is within 0.0034 and has the exact end values.
const float K1 = 1.9785f;
const float K3 = -0.2140f;
const float K5 = HALF_PI - K1 - K3;

float slice_k(float s) {
  float s2 = s * s;
  return s * (K1 + s2 * (K3 + s2 * K5));
}

// The density's integral over the slice: W = cos(gamma) + gamma sin(gamma), given k = K(sin gamma) of the chosen form.
float slice_total(float cos_gamma, float sin_gamma, float k) {
  return cos_gamma * cos_gamma * cos_gamma + sin_gamma * k;
}

// The normalised CDF on the side theta >= gamma: F = constant + c0 s^2 - c1 K(s). On the other side F = 1 - F', where F' is
// the mirrored slice's.
struct Measure {
  float constant;
  float c0;
  float c1;
};

Measure make_measure(float cos_gamma, float sin_gamma, float total) {
  Measure measure;
  measure.c0 = 0.5f * cos_gamma / total;
  measure.c1 = 0.5f * sin_gamma / total;
  measure.constant = 1.0f + measure.c1 * HALF_PI - measure.c0;
  return measure;
}

float measure_cdf(Measure measure, float s, float k) { return measure.constant + measure.c0 * s * s - measure.c1 * k; }

// F(theta) for any theta in [-pi/2, pi/2], exact, from its sine and the side it lies on (+1: theta >= gamma, -1: below).
float slice_cdf_exact(float cos_gamma, float sin_gamma, float s, float side) {
  float total = slice_total(cos_gamma, sin_gamma, slice_k_exact(sin_gamma));
  Measure measure = make_measure(cos_gamma, side * sin_gamma, total);
  float f = measure_cdf(measure, side * s, slice_k_exact(side * s));
  return side > 0.0f ? f : 1.0f - f;
}

// The same with the polynomial K.
float slice_cdf(float cos_gamma, float sin_gamma, float s, float side) {
  float total = slice_total(cos_gamma, sin_gamma, slice_k(sin_gamma));
  Measure measure = make_measure(cos_gamma, side * sin_gamma, total);
  float f = measure_cdf(measure, side * s, slice_k(side * s));
  return side > 0.0f ? f : 1.0f - f;
}

// First moment of the measure, from any fixed angle to theta, whose sine and cosine are s and c: the integral of
// (sin theta, cos theta) cos(theta) |sin(theta - gamma)| d theta. Between two horizons it is the bent normal.
vec2 moment_beyond_gamma(Slice slice, float s, float c) {
  float s3 = s * s * s * (1.0f / 3.0f);
  float c3 = c * c * c * (1.0f / 3.0f);
  return vec2(slice.cos_gamma * s3 + slice.sin_gamma * c3, -slice.cos_gamma * c3 - slice.sin_gamma * (s - s3));
}

vec2 slice_moment(Slice slice, float s, float c) {
  vec2 from_gamma = moment_beyond_gamma(slice, s, c) - moment_beyond_gamma(slice, slice.sin_gamma, slice.cos_gamma);
  return s >= slice.sin_gamma ? from_gamma : -from_gamma;
}

// The fast acos of the visibility-bitmask post: within 0.009.
float fast_acos(float x) {
  float a = min(abs(x), 1.0f);
  float angle = (HALF_PI - 0.156583f * a) * sqrt(1.0f - a);
  return x >= 0.0f ? angle : PI - angle;
}

// Sine of the angle of a direction, not necessarily unit, on the side theta >= gamma, given its oblique coordinates
// s = d.tangent, c = d.n / |n_p| and m = d.(unit normal of the slice) / |n_p|. In the slice m = 0 and (s, c) is the direction.
// A texel beside the slice is turned about n into it, so its height above the tangent plane counts, and a plane through the
// receiver stays exactly on its horizon. At grazing views m may exceed s, whose sign then says nothing: m^2 outweighs it.
// Below the horizon the angle ends at pi/2; it never crosses V.
float side_sine(float s, float c, float m, float sin_gamma) {
  float m2 = m * m;
  float away = m2 + s * abs(s);
  float sine = away * inversesqrt(away * away + c * c * (m2 + s * s) + 1e-30f);
  return c > 0.0f ? max(sine, sin_gamma) : 1.0f;
}

// --- azimuth ---

// Density of slices uniform in screen azimuth, relative to slices uniform about V; its mean over the azimuth is 1.
float azimuth_weight(vec3 v, vec3 direction) {
  float along = dot(direction, v);
  return abs(v.z) / (1.0f - along * along);
}

vec3 screen_direction(float azimuth) { return vec3(cos(azimuth), sin(azimuth), 0.0f); }

// The screen direction of a slice chosen uniformly about V: turn +z onto V, then slide along V into the screen plane.
vec3 view_direction(float azimuth, vec3 v) {
  float x = cos(azimuth);
  float y = sin(azimuth);
  float shared_part = (v.x * x + v.y * y) / (1.0f + v.z);
  vec3 about_v = vec3(x - v.x * shared_part, y - v.y * shared_part, -(v.x * x + v.y * y));
  vec3 in_screen = about_v - v * (about_v.z / v.z);
  return normalize(vec3(in_screen.x, in_screen.y, 0.0f));
}

#endif
