// Visibility bitmasks (Therrien, Levesque, Gilet 2023) with indirect diffuse light.
#version 460
#define BITMASK_LIGHT 1
#if BITMASK_AMBIENT
#include "params/vbgi"
#define bitmask vbgi
#endif
#include "gi/bitmask_main.glsl"
