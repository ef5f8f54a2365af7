// The slice inspector: one pixel of the technique taken apart, sample by sample (passes/gi/inspect.h).
#pragma once

#include <glm/glm.hpp>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "live/published.h"

namespace nf::editor {

enum class DotColor : int { Contribution, Slice };

struct SliceView {
  bool on = false, frozen = false;
  bool fan = true;            // slices drawn into the picture, too
  int slice = 0, shown = -1;  // samples of the slice that are shown, in their order; -1: all
  bool playing = false;       // a sample after the other, then the next slice
  double next_step = 0;       // seconds, ImGui::GetTime()
  DotColor color = DotColor::Contribution;
  std::optional<live::Inspected> seen;
  bool save_asked = false;
};

struct Editor;
// Another slice; more or fewer of its samples. Does nothing while no pixel is taken apart.
void step_slice(Editor& editor, int by);
void step_sample(Editor& editor, int by);
// While playing: a sample more whenever it is time, and round all slices.
void play_samples(Editor& editor, double now);

// Rows of `inspection.samples` that are of a slice, in their order.
std::vector<size_t> samples_of(const passes::Inspection& inspection, int slice);
// The angle from the slice's normal, radians, at which a position in sectors lies.
float angle_at(const passes::InspectedSlice& slice, float position);
// Angles of the slice that one of its first `shown` samples (-1: all) was the first to cover: a sector each, or what a
// horizon rose by. `number` counts the slice's samples from 0; `sector` is -1 of horizons.
struct Wedge {
  float from = 0, to = 0;
  int number = 0, sector = -1;
};
std::vector<Wedge> wedges_of(const passes::Inspection& inspection, int slice, int shown);
// Everything, and what it adds up to.
nlohmann::json to_json(const live::Inspected& seen);

}  // namespace nf::editor
