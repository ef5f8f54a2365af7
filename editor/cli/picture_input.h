// Pictures that commands read, from whichever kind of file.
#pragma once

#include <string>

#include "image/image.h"

namespace nf::editor {

struct PictureInput {
  image::Image image;   // linear, without alpha
  std::string layer;    // which one it was
  bool linear = false;  // the file's values were
};

// .exr (a layer of it; "" = R,G,B), .png (decoded from sRGB) or .hdr. `any_single`: where the layer is not there but
// the file has only one, take that. Throws nf::Error (Exit::Input) naming the layers there are.
PictureInput read_picture(const std::string& path, const std::string& layer, bool any_single = false);

}  // namespace nf::editor
