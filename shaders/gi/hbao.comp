// HBAO (Bavoil, Sainz, Dimitrov 2008): horizons, all open directions alike.
#version 460
#include "params/hbao"
#define horizon hbao
#define HORIZON_UNIFORM 1
#define HORIZON_MULTI_BOUNCE 0
#include "gi/horizon_main.glsl"
