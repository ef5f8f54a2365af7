#include "gi/inspect.h"

#include <algorithm>
#include <cstring>

#include "gi/techniques.h"

namespace nf::passes {
namespace {

// As shaders/gi/inspect.glsl has them.
constexpr size_t header_words = 32, slice_words = 64, sample_words = 32;
static_assert(sizeof(InspectedSample) == 25 * 4 && sizeof(InspectedSlice) == (16 + InspectedSlice::position_count) * 4);

}  // namespace

const char* inspect_reason_name(InspectReason reason) {
  constexpr const char* names[] = {"counted", "background", "outside radius", "off screen", "nothing new"};
  return names[size_t(reason)];
}

float Inspection::summed_visibility() const {
  double sum = slices.empty() ? 1 : 0;
  for (const InspectedSlice& slice : slices) sum += double(slice.base);
  for (const InspectedSample& sample : samples)
    sum -= double(slices[size_t(sample.slice)].factor) * double(sample.taken);
  return float(sum);
}

glm::vec3 Inspection::summed_gi() const {
  glm::dvec3 sum(0);
  for (const InspectedSample& sample : samples)
    sum += double(slices[size_t(sample.slice)].factor) * glm::dvec3(sample.light);
  return glm::vec3(sum) * gain;
}

size_t Inspection::count(InspectReason reason) const {
  return size_t(
      std::count_if(samples.begin(), samples.end(), [&](const InspectedSample& s) { return s.reason == reason; }));
}

InspectRequest make_inspect_request(const GiSettings& settings, glm::ivec2 pixel, glm::ivec2 size, int factor,
                                    glm::ivec2 offset, glm::ivec2 border) {
  InspectRequest request{.block = {}, .factor = glm::ivec2(factor), .offset = offset - border, .records = {}};
  const glm::ivec2 small = (size - offset + factor - 1) / factor;
  const glm::ivec2 texel = glm::clamp((pixel + border - offset) / factor, glm::ivec2(0), glm::max(small - 1, 0));
  request.block.x = texel.x;
  request.block.y = texel.y;
  request.block.slices = std::max(settings.shared.slices, settings.raymarch.rays);
  request.block.samples = std::max({2 * settings.shared.slices * settings.shared.steps, settings.ssao.samples,
                                    settings.ssdo.samples, settings.raymarch.rays * settings.shared.steps});
  return request;
}

uint64_t inspection_bytes(const InspectBlock& block) {
  return (header_words + size_t(block.slices) * slice_words + size_t(block.samples) * sample_words) * 4;
}

Inspection read_inspection(const InspectRequest& request, const graph::Readback& records) {
  const size_t words = records.texels.size() / 4;
  const size_t slice_rows = size_t(request.block.slices), sample_rows = size_t(request.block.samples);
  NF_CHECK(records.texels.size() == inspection_bytes(request.block), "{} words of {} slices and {} samples", words,
           slice_rows, sample_rows);
  std::vector<uint32_t> all(words);
  std::memcpy(all.data(), records.texels.data(), words * 4);
  const auto floats = [&](size_t at, void* to, size_t count) { std::memcpy(to, &all[at], count * 4); };
  Inspection out;
  const auto whole = [&](glm::ivec2 texel) { return texel * request.factor + request.offset; };
  out.pixel = whole({request.block.x, request.block.y});
  out.sectors = int32_t(all[2]);
  floats(3, &out.visibility, 1);
  floats(4, &out.gi, 3);
  floats(8, &out.depth, 1);
  floats(9, &out.ray, 3);
  floats(12, &out.v, 3);
  floats(15, &out.normal, 3);
  floats(18, &out.radius, 1);
  floats(19, &out.gain, 3);
  out.slices.resize(std::min(size_t(all[1]), slice_rows));
  for (size_t i = 0; i < out.slices.size(); ++i)
    floats(header_words + i * slice_words, &out.slices[i], sizeof(InspectedSlice) / 4);
  out.samples.resize(std::min(size_t(all[0]), sample_rows));
  for (size_t i = 0; i < out.samples.size(); ++i) {
    InspectedSample& sample = out.samples[i];
    floats(header_words + slice_rows * slice_words + i * sample_words, &sample, sizeof(InspectedSample) / 4);
    NF_CHECK(sample.slice >= 0 && size_t(sample.slice) < out.slices.size() && sample.reason >= InspectReason::Counted &&
                 sample.reason <= InspectReason::NothingNew,
             "sample {} is of slice {} of {}", i, sample.slice, out.slices.size());
    sample.texel = whole(sample.texel);
  }
  return out;
}

}  // namespace nf::passes
