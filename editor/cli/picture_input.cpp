// Reading of pictures by the ending of their name.
#include "cli/picture_input.h"

#include <algorithm>
#include <filesystem>

#include "core/error.h"

namespace nf::editor {
namespace {

// Alpha is no light: RGBA becomes RGB.
image::Image without_alpha(image::Image in, bool alpha) {
  if (!alpha || in.channels < 2) return in;
  image::Image out{in.width, in.height, in.channels - 1, {}};
  out.pixels.reserve(size_t(in.width) * in.height * out.channels);
  for (size_t i = 0; i < in.pixels.size(); ++i)
    if (i % in.channels != in.channels - 1) out.pixels.push_back(in.pixels[i]);
  return out;
}

PictureInput read_exr_layer(const std::string& path, const std::string& wanted, bool any_single) {
  image::ExrFile file = image::read_exr(path);
  auto found =
      std::find_if(file.layers.begin(), file.layers.end(), [&](const image::Layer& l) { return l.name == wanted; });
  if (found == file.layers.end() && (any_single || wanted.empty()) && file.layers.size() == 1)
    found = file.layers.begin();
  if (found == file.layers.end()) {
    std::string names;
    for (const image::Layer& l : file.layers) names += fmt::format(" '{}'", l.name);
    fail(Exit::Input, "no layer '{}' in '{}'; it has{} ('' is the final radiance R,G,B)", wanted, path, names);
  }
  const bool alpha = found->channels.size() > 1 && found->channels.back() == 'A';
  return {without_alpha(std::move(found->image), alpha), found->name, true};
}

}  // namespace

PictureInput read_picture(const std::string& path, const std::string& layer, bool any_single) {
  const std::string extension = std::filesystem::path(path).extension().string();
  if (extension == ".exr") return read_exr_layer(path, layer, any_single);
  if (!layer.empty() && !any_single)
    fail(Exit::Input, "no layer '{}' in '{}': only EXR files have layers", layer, path);
  if (extension == ".hdr") return {image::read_hdr(path), "", true};
  if (extension != ".png") fail(Exit::Input, "cannot read '{}': the name must end in .exr, .png or .hdr", path);
  const image::Image8 in = image::read_png(path);
  image::Image out{in.width, in.height, in.channels, {}};
  out.pixels.reserve(in.pixels.size());
  for (const uint8_t value : in.pixels) out.pixels.push_back(image::linear_from_srgb(float(value) / 255));
  return {without_alpha(std::move(out), in.channels == 4), "", false};
}

}  // namespace nf::editor
