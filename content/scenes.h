// The bundled scenes, each as the bytes of a GLB file. Same bytes on every call.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace nf::content {

// The Cornell box in metres: x and z in [-1,1], y in [0,2], open to +Z, lit by an emissive quad below the ceiling.
// Cameras "front" and "corner". The short box slides to and fro with a period of 4 s.
std::vector<uint8_t> cornell();

// Thin bars, rails and an alpha-masked card 0.35 m and more before a brick wall in the sun. Cameras "front" and "side".
// The card turns with a period of 4 s.
std::vector<uint8_t> fence();

// A closed room, 2 m each way about (0,1,0), whose every face has base colour 0.8 and emits a radiance of 1: with pure
// Lambert materials (material.lambert=true) every point's radiance is 1 / (1 - 0.8) = 5 after all bounces. Cameras
// "centre" and "corner", both inside.
std::vector<uint8_t> furnace();

// A court of two storeys of arches under an open roof, with curtains in three colours, banners, plants and lanterns, in
// the sun: light that reaches most of it only by bouncing. 200,000 triangles. Cameras "court", "gallery", "aisle" and
// "fountain". Banners (skinned) and lanterns (with their lights) swing with a period of 4 s.
std::vector<uint8_t> atrium();
// A view file for it: the camera "court", and the sky, which glTF has no words for.
std::string atrium_view();

}  // namespace nf::content
