// The bundled scenes, each as the bytes of a GLB file. Same bytes on every call.
#pragma once

#include <cstdint>
#include <vector>

namespace nf::content {

// The Cornell box in metres: x and z in [-1,1], y in [0,2], open to +Z, lit by an emissive quad below the ceiling.
// Cameras "front" and "corner".
std::vector<uint8_t> cornell();

// Thin bars, rails and an alpha-masked card 0.35 m and more before a brick wall in the sun. Cameras "front" and "side".
std::vector<uint8_t> fence();

// A closed room, 2 m each way about (0,1,0), whose every face has base colour 0.8 and emits a radiance of 1: with pure
// Lambert materials (material.lambert=true) every point's radiance is 1 / (1 - 0.8) = 5 after all bounces. Cameras
// "centre" and "corner", both inside.
std::vector<uint8_t> furnace();

}  // namespace nf::content
