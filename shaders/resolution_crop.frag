// The picture without its border.
#version 460
#include "params/crop"

uniform texture2D source;
layout(location = 0) out vec4 cropped;

void main() { cropped = texelFetch(source, ivec2(gl_FragCoord.xy) + crop.offset, 0); }
