// The picked pixel: its values as text and JSON, and which pixel a text means.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "live/published.h"

namespace nf::editor {

// "gbuffer.depth", "feedback.pushed mip 2", "resolution.gi_layers layer 1".
std::string title_of(const live::ImageValue& image);
// All digits that tell a float from its neighbours; integers as they are stored.
std::string text_of(const std::vector<float>& values);
std::string text_of(const live::ImageValue& image);
// NaN and infinities, which JSON has not, are strings.
nlohmann::json to_json(const live::Picked& picked);

// "412,233", "412 233": a pixel of a picture of this size. Else the fault, a sentence.
std::string parse_pixel(const std::string& text, glm::uvec2 size, glm::uvec2& pixel);

}  // namespace nf::editor
