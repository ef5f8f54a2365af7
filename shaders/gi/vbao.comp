// Visibility bitmasks (Therrien, Levesque, Gilet 2023): visibility, bent normal and the environment by direction.
#version 460
#define BITMASK_LIGHT 0
#if BITMASK_AMBIENT
#include "params/vbao"
#define bitmask vbao
#endif
#include "gi/bitmask_main.glsl"
