// Generated pictures of the atrium: stone, floors, cloth, wood, a leaf. All but the leaf tile; colours are sRGB,
// normals in glTF's convention.
#pragma once

#include "image/image.h"

namespace nf::content {

struct Relief {
  image::Image8 color, normal;
};

Relief ashlar_pictures(uint32_t size);  // 6 courses of 3 blocks: a wall of cut stone
Relief floor_pictures(uint32_t size);   // 2 x 2 slabs about a small dark square, as in old halls
Relief plaster_pictures(uint32_t size);
Relief cloth_pictures(uint32_t size);  // woven, with a border of lighter diamonds; grey, for a coloured material
image::Image8 wood_picture(uint32_t size);
// One broad leaf, its stalk at the middle of the lower edge; 4 channels, alpha 0 or 255.
image::Image8 broad_leaf_picture(uint32_t size);

}  // namespace nf::content
