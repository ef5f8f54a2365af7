// How a texel of a neighbour is read: imageLoad from a storage image where that is the fast way (software devices), else
// texelFetch. NF_FETCH_STORAGE is a device fact, the same for all shaders.
#ifndef NF_COMMON_FETCH_GLSL
#define NF_COMMON_FETCH_GLSL

#ifdef NF_FETCH_STORAGE
#define FETCH_FLOAT_IMAGE(name) layout(r32f) uniform readonly image2D name
#define FETCH_UINT_IMAGE(name) layout(r32ui) uniform readonly uimage2D name
#define FETCH(name, texel) imageLoad(name, texel).x
#else
#define FETCH_FLOAT_IMAGE(name) uniform texture2D name
#define FETCH_UINT_IMAGE(name) uniform utexture2D name
#define FETCH(name, texel) texelFetch(name, texel, 0).x
#endif

#endif
