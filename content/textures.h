// Generated pictures of the bundled scenes. All of them tile.
#pragma once

#include "image/image.h"

namespace nf::content {

// A running bond of 4 x 12 bricks: colour (sRGB, 3 channels) and normals (tangent space, glTF's convention: +Y up).
struct Bricks {
  image::Image8 color, normal;
};
Bricks brick_pictures(uint32_t size);

// Leaves on nothing: colour (sRGB) with 4 channels, alpha 0 or 255.
image::Image8 leaf_picture(uint32_t size);

}  // namespace nf::content
