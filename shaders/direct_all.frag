// What the GI gathers with the direct specular light as the eye sees it: the report's allLight (Colliander, Tornquist 2015).
#version 460
#include "common/fetch.glsl"
#include "common/pack.glsl"

FETCH_UINT_IMAGE(radiance);
uniform texture2D direct_specular;
layout(location = 0) out uint all;

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  all = pack_rgb9e5(unpack_rgb9e5(FETCH(radiance, pixel)) + texelFetch(direct_specular, pixel, 0).rgb);
}
