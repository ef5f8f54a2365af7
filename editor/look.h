// How pictures of floats are shown: what shaders/ui_picture.frag does, on the host, and ranges that fit.
#pragma once

#include <array>
#include <string>

#include "live/published.h"
#include "ui/renderer.h"

namespace nf::editor {

inline constexpr const char* map_names[] = {"grey", "viridis", "diverging", "false colour"};  // by ui::Map

// What the window shows for a texel of four floats, 0 to 1 and a little beyond.
std::array<float, 3> shown_color(const float* value, const ui::PictureLook& look);
// "RGB", "A"; "none".
std::string channels_text(const ui::PictureLook& look);
// As many channels as the picture has, when it has another number of them than the last one.
void choose_channels(const live::Pixels& pixels, ui::PictureLook& look);
// From the smallest to the largest number of the channels that are shown; what has two signs, about zero in the map
// that has a middle.
void fit_range(const live::Pixels& pixels, ui::PictureLook& look);
// .png as `look` shows it, .exr as it is.
void save_pixels(const std::string& path, const live::Pixels& pixels, const ui::PictureLook& look);

}  // namespace nf::editor
