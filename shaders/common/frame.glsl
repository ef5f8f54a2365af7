// The frame's cameras and lights: uniform block `frame` (passes/view.h says what its members mean).
#ifndef NF_COMMON_FRAME_GLSL
#define NF_COMMON_FRAME_GLSL
#include "params/frame"
#endif
