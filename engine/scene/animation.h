// Animation: from a time to the pose of the scene.
//
// Time is in seconds from the scene's own zero, and a scene's pose is a function of the time alone. A clip starts at 0,
// lasts until its last key and then starts again: it is sampled at time modulo its duration. Before a property's first
// key and behind its last it keeps that key's value. All clips play at once unless told otherwise (Clip::plays); where
// two drive one property the later one wins. What no playing clip drives is at rest, as the file has it.
#pragma once

#include <span>

#include "scene/update.h"

namespace nf::scene {

// Poses the scene for a time and updates it: one frame's step. Velocities are those from the time of the call before.
Changes animate(Scene& scene, double seconds);

// `seconds` within a clip of this length.
float clip_time(double seconds, float duration);

// The value of a sampler at a time within its clip, into `value` (width floats). With `rotation` the four floats are a
// quaternion (x, y, z, w): linear keys turn the shorter way at an even pace, and the result is of unit length.
void sample(const Animations& animations, const AnimationSampler& sampler, float time, bool rotation,
            std::span<float> value);

}  // namespace nf::scene
