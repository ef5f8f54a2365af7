// GTAO (Jimenez, Wu, Pesce, Jarabo 2016): horizons, integrated with the receiver's cosine.
#version 460
#include "params/gtao"
#define horizon gtao
#define HORIZON_UNIFORM 0
#include "gi/horizon_main.glsl"
