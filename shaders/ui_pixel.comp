// One texel of a picture that lies on the device, for the line that tells what is under the pointer.
#version 460
#include "params/ui_pixel"

layout(local_size_x = 1) in;
uniform texture2D shown;
layout(scalar) writeonly buffer texel_table { uint rows[]; } texels;

void main() {
  texels.rows[0] = packUnorm4x8(texelFetch(shown, ui_pixel.place, 0));
}
