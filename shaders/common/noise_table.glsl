// The image behind the kinds of common/noise.glsl that need one. Sampled everywhere: it lives outside the frame, and a pixel
// reads one texel of it.
#ifndef NF_COMMON_NOISE_TABLE_GLSL
#define NF_COMMON_NOISE_TABLE_GLSL

#if NOISE_KIND == 3 || NOISE_KIND == 4  // blue, stbn
uniform utexture2D noise_table;
#define FETCH_NOISE(texel) texelFetch(noise_table, texel, 0).x
#endif

#endif
