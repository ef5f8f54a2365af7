// Sampling of keys (glTF 2.0, Appendix C), and the pose they make.
#include "scene/animation.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.h"

namespace nf::scene {

namespace {

// Of unit length: quantized keys are not.
quat load_quat(const float* v) {
  return glm::normalize(quat(v[3], v[0], v[1], v[2]));
}

void store_quat(const quat& q, std::span<float> value) {
  value[0] = q.x, value[1] = q.y, value[2] = q.z, value[3] = q.w;
}

struct Segment {
  size_t key;      // the one at or before the time
  float fraction;  // of the way to the next; 0 at the last key
  float length;    // seconds between the two
};

Segment find_segment(std::span<const float> times, float time) {
  const auto after = std::upper_bound(times.begin(), times.end(), time);
  if (after == times.begin()) return {0, 0, 0};
  const size_t key = size_t(after - times.begin()) - 1;
  if (key + 1 == times.size()) return {key, 0, 0};
  const float length = times[key + 1] - times[key];
  return {key, length > 0 ? (time - times[key]) / length : 0, length};
}

// Cubic Hermite: tangents are per second, so they are scaled by the segment's length.
void cubic(const float* from, const float* to, size_t width, const Segment& segment, std::span<float> value) {
  const float t = segment.fraction, t2 = t * t, t3 = t2 * t, d = segment.length;
  for (size_t i = 0; i < width; ++i) {
    const float start = from[width + i], out_tangent = from[2 * width + i], in_tangent = to[i], end = to[width + i];
    value[i] = (2 * t3 - 3 * t2 + 1) * start + d * (t3 - 2 * t2 + t) * out_tangent + (3 * t2 - 2 * t3) * end +
               d * (t3 - t2) * in_tangent;
  }
}

}  // namespace

float clip_time(double seconds, float duration) {
  if (!(duration > 0) || !std::isfinite(seconds)) return 0;
  const double wrapped = std::fmod(seconds, double(duration));
  return float(wrapped < 0 ? wrapped + double(duration) : wrapped);
}

void sample(const Animations& animations, const AnimationSampler& sampler, float time, bool rotation,
            std::span<float> value) {
  NF_CHECK(value.size() == sampler.width, "{} floats for a sampler of {}", value.size(), sampler.width);
  const size_t width = sampler.width;
  const bool spline = sampler.interpolation == Interpolation::CubicSpline;
  const size_t stride = spline ? 3 * width : width;
  const Segment segment = find_segment(std::span(animations.time).subspan(sampler.first_key, sampler.key_count), time);
  const float* from = animations.value.data() + sampler.first_value + segment.key * stride;
  const float* to = from + stride;
  if (segment.fraction == 0 || sampler.interpolation == Interpolation::Step) {
    std::copy_n(from + (spline ? width : 0), width, value.begin());
  } else if (spline) {
    cubic(from, to, width, segment, value);
  } else if (rotation) {
    store_quat(glm::slerp(load_quat(from), load_quat(to), segment.fraction), value);
  } else {
    for (size_t i = 0; i < width; ++i) value[i] = from[i] + segment.fraction * (to[i] - from[i]);
  }
  if (rotation) store_quat(load_quat(value.data()), value);
}

Changes animate(Scene& scene, double seconds) {
  const Animations& animations = scene.animations;
  std::vector<vec3> translation = animations.rest_translation, scale = animations.rest_scale;
  std::vector<quat> rotation = animations.rest_rotation;
  scene.morph_weights.wanted = animations.rest_weight;
  for (const Clip& clip : animations.clips) {
    if (!clip.plays) continue;
    const float time = clip_time(seconds, clip.duration);
    for (uint32_t i = clip.first_channel; i < clip.first_channel + clip.channel_count; ++i) {
      const AnimationChannel& channel = animations.channels[i];
      const AnimationSampler& sampler = animations.samplers[channel.sampler];
      if (channel.path == AnimatedPath::Weights) {
        const std::span<float> weights(scene.morph_weights.wanted);
        sample(animations, sampler, time, false, weights.subspan(channel.target, sampler.width));
        continue;
      }
      std::array<float, 4> value{};
      const bool turns = channel.path == AnimatedPath::Rotation;
      sample(animations, sampler, time, turns, std::span(value).first(sampler.width));
      if (turns) rotation[channel.target] = load_quat(value.data());
      if (channel.path == AnimatedPath::Translation) translation[channel.target] = {value[0], value[1], value[2]};
      if (channel.path == AnimatedPath::Scale) scale[channel.target] = {value[0], value[1], value[2]};
    }
  }
  for (size_t i = 0; i < animations.rest_node.size(); ++i) {
    set_local(scene.nodes, animations.rest_node[i], translation[i], rotation[i], scale[i]);
  }
  return update(scene);
}

}  // namespace nf::scene
