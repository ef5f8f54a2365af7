// What a technique gave for a pixel (HAS_GI, HAS_VISIBILITY, HAS_AMBIENT, HAS_BENT say what), made fit for averaging: a NaN or
// infinity takes the mean of its neighbours, light far above its surroundings is clamped. The including file declares
// FETCH_FLOAT_IMAGE(depth) and has common/{color,fetch}.glsl.
#ifndef NF_COMMON_GI_SAMPLE_GLSL
#define NF_COMMON_GI_SAMPLE_GLSL

#ifdef HAS_GI
uniform texture2D gi;
#endif
#ifdef HAS_VISIBILITY
uniform texture2D visibility;
#endif
#ifdef HAS_AMBIENT
uniform texture2D ambient;
#endif
#ifdef HAS_BENT
uniform texture2D bent;
#endif

struct GiSample {
  vec3 gi;
  float visibility;
  vec3 ambient;
  vec3 bent;
};

GiSample read_sample(ivec2 pixel) {
  GiSample s = GiSample(vec3(0.0), 1.0, vec3(0.0), vec3(0.0));
#ifdef HAS_GI
  s.gi = texelFetch(gi, pixel, 0).rgb;
#endif
#ifdef HAS_VISIBILITY
  s.visibility = texelFetch(visibility, pixel, 0).x;
#endif
#ifdef HAS_AMBIENT
  s.ambient = texelFetch(ambient, pixel, 0).rgb;
#endif
#ifdef HAS_BENT
  s.bent = texelFetch(bent, pixel, 0).xyz;
#endif
  return s;
}

bool is_number(GiSample s) { return is_number(s.gi) && is_number(s.visibility) && is_number(s.ambient) && is_number(s.bent); }

// What variance and edges of light are judged by.
float brightness(GiSample s) {
#ifdef HAS_GI
  return luminance(s.gi);
#else
  return s.visibility;
#endif
}

GiSample add_weighted(GiSample sum, GiSample s, float w) {
  return GiSample(sum.gi + s.gi * w, sum.visibility + s.visibility * w, sum.ambient + s.ambient * w, sum.bent + s.bent * w);
}
GiSample nothing() { return GiSample(vec3(0.0), 0.0, vec3(0.0), vec3(0.0)); }

// `before` is the brightness so far, 0 for none; `clamp_at`, if not 0, how many times brighter than that and than the four
// neighbours' mean a pixel may be. `removed` is the luminance taken away.
GiSample clean_sample(ivec2 pixel, ivec2 size, float z, float before, float clamp_at, out float removed) {
  GiSample s = read_sample(pixel);
  GiSample around = nothing();
  float weights = 0.0;
  for (int i = 0; i < 4; ++i) {
    ivec2 q = pixel + ivec2(i < 2 ? 2 * i - 1 : 0, i < 2 ? 0 : 2 * i - 5);
    bool inside = all(greaterThanEqual(q, ivec2(0))) && all(lessThan(q, size));
    q = clamp(q, ivec2(0), size - 1);
    GiSample neighbour = read_sample(q);
    if (inside && abs(FETCH(depth, q) - z) < 0.05 * z && is_number(neighbour)) {
      around = add_weighted(around, neighbour, 1.0);
      weights += 1.0;
    }
  }
  removed = 0.0;
  if (!is_number(s)) {
    s = GiSample(vec3(0.0), 1.0, vec3(0.0), vec3(0.0));
    if (weights > 0.0) s = add_weighted(nothing(), around, 1.0 / weights);
  }
#ifdef HAS_GI
  float bright = luminance(s.gi);
  float limit = clamp_at * max(luminance(around.gi) / max(weights, 1.0), before);
  if (clamp_at > 0.0 && weights > 0.0 && limit > 0.0 && bright > limit) {
    removed = bright - limit;
    s.gi *= limit / bright;
  }
#endif
  return s;
}

#endif
