#include "slice_view.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "editor.h"

namespace nf::editor {
namespace {

using nlohmann::json;

json list(glm::vec3 v) {
  return {v.x, v.y, v.z};
}

std::string hex(const std::array<uint32_t, 4>& words, int sectors) {
  std::string text;
  for (int word = (std::max(sectors, 0) + 31) / 32; word-- > 0;) text += fmt::format("{:08x}", words[size_t(word)]);
  return text;
}

}  // namespace

void step_slice(Editor& editor, int by) {
  SliceView& s = editor.slices;
  if (!s.on || !s.seen || s.seen->data.slices.empty()) return;
  const int count = int(s.seen->data.slices.size());
  s.slice = (s.slice + by + count) % count;
}

void step_sample(Editor& editor, int by) {
  SliceView& s = editor.slices;
  if (!s.on || !s.seen) return;
  const int count = int(samples_of(s.seen->data, s.slice).size());
  // From all of them one step further is none.
  const int now = s.shown < 0 ? (by > 0 ? 0 : count) : s.shown;
  s.shown = std::clamp(now + by, 0, count);
}

void play_samples(Editor& editor, double now) {
  constexpr double seconds = 0.25;
  SliceView& s = editor.slices;
  if (!s.playing || !s.on || !s.seen || s.seen->data.slices.empty() || now < s.next_step) return;
  s.next_step = now + seconds;
  if (s.shown >= int(samples_of(s.seen->data, s.slice).size())) {
    step_slice(editor, 1);
    s.shown = 0;
  } else {
    s.shown = std::max(s.shown, 0) + 1;
  }
}

std::vector<size_t> samples_of(const passes::Inspection& inspection, int slice) {
  std::vector<size_t> rows;
  for (size_t i = 0; i < inspection.samples.size(); ++i)
    if (inspection.samples[i].slice == slice) rows.push_back(i);
  return rows;
}

float angle_at(const passes::InspectedSlice& slice, float position) {
  constexpr float pi = 3.14159265f;
  const auto& p = slice.positions;
  const auto above = std::upper_bound(p.begin(), p.end(), position);
  if (above == p.begin()) return -pi / 2;
  if (above == p.end()) return pi / 2;
  const size_t i = size_t(above - p.begin()) - 1;
  const float share = (position - p[i]) / std::max(p[i + 1] - p[i], 1e-9f);
  return ((float(i) + share) / float(p.size() - 1) - 0.5f) * pi;
}

std::vector<Wedge> wedges_of(const passes::Inspection& inspection, int slice, int shown) {
  constexpr float pi = 3.14159265f;
  std::vector<Wedge> wedges;
  float edge[2] = {pi / 2, -pi / 2};
  int number = 0;
  for (const size_t row : samples_of(inspection, slice)) {
    if (shown >= 0 && number >= shown) break;
    const passes::InspectedSample& sample = inspection.samples[row];
    for (int bit = 0; bit < inspection.sectors; ++bit)
      if (sample.fresh[size_t(bit / 32)] >> (bit % 32) & 1u) {
        const passes::InspectedSlice& own = inspection.slices[size_t(slice)];
        wedges.push_back({angle_at(own, float(bit)), angle_at(own, float(bit + 1)), number, bit});
      }
    if (inspection.sectors == 0 && sample.reason == passes::InspectReason::Counted) {
      float& far = edge[sample.side];
      if (sample.taken > 0) wedges.push_back({std::min(sample.front, far), std::max(sample.front, far), number, -1});
      far = sample.front;
    }
    ++number;
  }
  return wedges;
}

json to_json(const live::Inspected& seen) {
  const passes::Inspection& in = seen.data;
  json slices = json::array(), samples = json::array(), reasons = json::object();
  for (const passes::InspectedSlice& s : in.slices)
    slices.push_back({{"factor", s.factor},
                      {"base", s.base},
                      {"weight", s.weight},
                      {"total", s.total},
                      {"gamma", std::atan2(s.sin_gamma, s.cos_gamma)},
                      {"n_length", s.n_length},
                      {"direction", list(s.direction)},
                      {"tangent", list(s.tangent)},
                      {"normal", list(s.normal)}});
  for (const passes::InspectedSample& s : in.samples)
    samples.push_back({{"slice", s.slice},
                       {"side", s.side},
                       {"step", s.step},
                       {"reason", passes::inspect_reason_name(s.reason)},
                       {"texel", {s.texel.x, s.texel.y}},
                       {"depth", s.depth},
                       {"towards", list(s.towards)},
                       {"front", s.front},
                       {"back", s.back},
                       {"weight", s.weight},
                       {"before", hex(s.before, in.sectors)},
                       {"fresh", hex(s.fresh, in.sectors)},
                       {"taken", s.taken},
                       {"light", list(s.light)}});
  for (int i = 0; i <= int(passes::InspectReason::NothingNew); ++i)
    reasons[passes::inspect_reason_name(passes::InspectReason(i))] = in.count(passes::InspectReason(i));
  return {{"schema", "nearfield.inspection/1"},
          {"technique", seen.technique},
          {"frame", seen.frame},
          {"picture", {seen.size.x, seen.size.y}},
          {"pixel", {in.pixel.x, in.pixel.y}},
          {"sectors", in.sectors},
          {"radius", in.radius},
          {"position", list(in.ray * in.depth)},
          {"view", list(in.v)},
          {"normal", list(in.normal)},
          {"gain", list(in.gain)},
          {"shader", {{"visibility", in.visibility}, {"gi", list(in.gi)}}},
          {"sum", {{"visibility", in.summed_visibility()}, {"gi", list(in.summed_gi())}}},
          {"samples_by_reason", reasons},
          {"slices", slices},
          {"samples", samples}};
}

}  // namespace nf::editor
