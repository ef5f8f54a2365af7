// Animations into flat tables of keys. The clip's channels that drive nothing in the scene are left out.
#include <algorithm>
#include <cmath>

#include "scene/gltf_accessor.h"
#include "scene/text.h"

namespace nf::scene::gltf {

namespace {

constexpr unsigned any_fraction = as_float | as_u8 | as_u16 | as_i8 | as_i16;

struct Target {
  AnimatedPath path;
  uint32_t row;    // of rest_node, or the first of MorphWeights
  uint32_t width;  // floats a key
};

uint32_t rest_row(Importer& importer, uint32_t node, std::map<uint32_t, uint32_t>& rest_rows) {
  Animations& animations = importer.scene.animations;
  const auto [entry, added] = rest_rows.try_emplace(node, uint32_t(animations.rest_node.size()));
  if (added) {
    const Nodes& nodes = importer.scene.nodes;
    animations.rest_node.push_back(node);
    animations.rest_translation.push_back(nodes.translation[node]);
    animations.rest_rotation.push_back(nodes.rotation[node]);
    animations.rest_scale.push_back(nodes.scale[node]);
  }
  return entry->second;
}

// False where the channel drives nothing that is there.
bool find_target(Importer& importer, const tinygltf::AnimationChannel& channel, std::map<uint32_t, uint32_t>& rest_rows,
                 Target& target) {
  if (channel.target_node < 0) return false;
  const uint32_t node = importer.node_rows[size_t(channel.target_node)];
  if (node == none) return false;
  if (channel.target_path == "weights") {
    const Nodes& nodes = importer.scene.nodes;
    target = {AnimatedPath::Weights, nodes.first_weight[node], nodes.weight_count[node]};
    return target.width > 0;
  }
  const bool turns = channel.target_path == "rotation";
  const AnimatedPath path = turns                                  ? AnimatedPath::Rotation
                            : channel.target_path == "translation" ? AnimatedPath::Translation
                                                                   : AnimatedPath::Scale;
  if (!turns && path == AnimatedPath::Scale && channel.target_path != "scale") {
    importer.warn_once("animations of anything but nodes and weights are skipped");
    return false;
  }
  target = {path, rest_row(importer, node, rest_rows), turns ? 4u : 3u};
  return true;
}

void read_times(const Elements& input, const std::string& where, std::vector<float>& time) {
  float last = 0;
  for (size_t i = 0; i < input.count; ++i) {
    const float value = read_float(input, i, 0);
    if (!(value >= last && value < 1e9f)) refuse("{} has times that do not rise from 0 (key {})", where, i);
    time.push_back(last = value);
  }
}

AnimationSampler import_sampler(Importer& importer, const tinygltf::AnimationSampler& source, const Target& target,
                                const std::string& where) {
  Animations& animations = importer.scene.animations;
  AnimationSampler sampler;
  sampler.interpolation = source.interpolation == "STEP"          ? Interpolation::Step
                          : source.interpolation == "CUBICSPLINE" ? Interpolation::CubicSpline
                                                                  : Interpolation::Linear;
  const int components = target.path == AnimatedPath::Weights ? 1 : int(target.width);
  const unsigned allowed = components == 3 ? as_float | (importer.quantized ? any_fraction : 0) : any_fraction;
  const Elements input = open_accessor(importer, source.input, as_float, 1, 1, where + " input");
  Elements output = open_accessor(importer, source.output, allowed, components, components, where + " output");
  output.normalized = true;
  const size_t per_key = (sampler.interpolation == Interpolation::CubicSpline ? 3 : 1) * size_t(target.width);
  if (input.count == 0) refuse("{} has no keys", where);
  if (input.count > output.count || output.count * size_t(components) != input.count * per_key) {
    refuse("{} has {} times, but {} values where {} are expected", where, input.count, output.count,
           input.count * per_key / size_t(components));
  }
  importer.budget.take(uint64_t(input.count) * (per_key + 1) * 4, "animations");
  sampler.first_key = uint32_t(animations.time.size());
  sampler.key_count = uint32_t(input.count);
  sampler.first_value = uint32_t(animations.value.size());
  sampler.width = target.width;
  read_times(input, where, animations.time);
  for (size_t i = 0; i < output.count; ++i) {
    for (int component = 0; component < components; ++component) {
      const float value = read_float(output, i, component);
      if (!(std::abs(value) < 1e18f)) refuse("{} has a value that is not finite (key {})", where, i);
      animations.value.push_back(value);
    }
  }
  return sampler;
}

void import_animation(Importer& importer, size_t row, std::map<uint32_t, uint32_t>& rest_rows) {
  const tinygltf::Animation& source = importer.model.animations[row];
  Animations& animations = importer.scene.animations;
  Clip clip;
  clip.name = one_line(source.name.empty() ? fmt::format("animation {}", row) : source.name);
  clip.first_channel = uint32_t(animations.channels.size());
  std::map<std::pair<int, uint32_t>, uint32_t> samplers;  // a sampler may serve channels of different widths
  for (const tinygltf::AnimationChannel& channel : source.channels) {
    Target target;
    if (!find_target(importer, channel, rest_rows, target)) continue;
    const auto [entry, added] =
        samplers.try_emplace({channel.sampler, target.width}, uint32_t(animations.samplers.size()));
    if (added) {
      const std::string where = fmt::format("animations[{}].samplers[{}]", row, channel.sampler);
      animations.samplers.push_back(import_sampler(importer, source.samplers[size_t(channel.sampler)], target, where));
    }
    const AnimationSampler& sampler = animations.samplers[entry->second];
    clip.duration = std::max(clip.duration, animations.time[sampler.first_key + sampler.key_count - 1]);
    animations.channels.push_back({entry->second, target.row, target.path});
  }
  clip.channel_count = uint32_t(animations.channels.size()) - clip.first_channel;
  if (clip.channel_count > 0) animations.clips.push_back(std::move(clip));
}

}  // namespace

void import_animations(Importer& importer) {
  std::map<uint32_t, uint32_t> rest_rows;
  for (size_t i = 0; i < importer.model.animations.size(); ++i) import_animation(importer, i, rest_rows);
  importer.scene.animations.rest_weight = importer.scene.morph_weights.value;
}

}  // namespace nf::scene::gltf
