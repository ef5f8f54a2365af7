#include "pixel.h"

#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

namespace nf::editor {

using nlohmann::json;

namespace {

json numbers(const std::vector<float>& values) {
  json out = json::array();
  for (const float x : values) {
    if (std::isfinite(x))
      out.push_back(x);
    else
      out.push_back(std::isnan(x) ? "nan" : x > 0 ? "inf" : "-inf");
  }
  return out;
}

}  // namespace

std::string title_of(const live::ImageValue& image) {
  std::string text = image.name;
  if (image.mips > 1) text += fmt::format(" mip {}", image.mip);
  if (image.layers > 1) text += fmt::format(" layer {}", image.layer);
  return text;
}

std::string text_of(const std::vector<float>& values) {
  return fmt::format("{}", fmt::join(values, "  "));
}
std::string text_of(const live::ImageValue& image) {
  return image.numbers.empty() ? text_of(image.values) : fmt::format("{}", fmt::join(image.numbers, "  "));
}

json to_json(const live::Picked& picked) {
  json layers = json::object(), images = json::array();
  for (const live::LayerValue& layer : picked.layers) layers[layer.name] = numbers(layer.values);
  for (const live::ImageValue& image : picked.images) {
    json row = {{"name", image.name},
                {"format", image.format},
                {"mip", image.mip},
                {"layer", image.layer},
                {"size", {image.size.x, image.size.y}},
                {"after", image.pass}};
    if (image.of_view) {
      row["texel"] = {image.texel.x, image.texel.y};
      row["values"] = image.numbers.empty() ? numbers(image.values) : json(image.numbers);
    }
    if (!image.meaning.empty()) row["unpacked"] = {{"as", image.meaning}, {"values", numbers(image.unpacked)}};
    images.push_back(std::move(row));
  }
  return {{"pixel", {picked.pixel.x, picked.pixel.y}},
          {"size", {picked.made_with.size.x, picked.made_with.size.y}},
          {"technique", picked.made_with.settings.technique->id},
          {"layers", layers},
          {"images", images}};
}

std::string parse_pixel(const std::string& text, glm::uvec2 size, glm::uvec2& pixel) {
  glm::uvec2 read{0};
  const char *at = text.data(), *end = at + text.size();
  const auto skip = [&](bool comma) {
    while (at < end && (*at == ' ' || (comma && *at == ','))) {
      if (*at == ',') comma = false;
      ++at;
    }
  };
  for (int i = 0; i < 2; ++i) {
    skip(i == 1);
    const auto [next, error] = std::from_chars(at, end, read[i]);
    if (error == std::errc::result_out_of_range)
      read[i] = ~0u;
    else if (error != std::errc())
      return fmt::format("'{}' is no pixel: two numbers are, such as {},{}", text, size.x / 2, size.y / 2);
    at = next;
  }
  skip(false);
  if (at != end) return fmt::format("'{}' is no pixel: two numbers are, such as {},{}", text, size.x / 2, size.y / 2);
  if (read.x >= size.x || read.y >= size.y)
    return fmt::format("outside the picture, whose last pixel is {},{}", size.x - 1, size.y - 1);
  pixel = read;
  return {};
}

}  // namespace nf::editor
