// The counterparts of common/pack.glsl and common/denoise.glsl on the host.
#include "packed.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/gtc/packing.hpp>

namespace nf::passes {
namespace {

enum class Packing : uint8_t { Normal, Light, State, Depth, Pixel };
struct Row {
  std::string_view image;
  Packing packing;
};
constexpr Row rows[] = {{"gbuffer.normal", Packing::Normal},    {"previous.normal", Packing::Normal},
                        {"resolution.normal", Packing::Normal}, {"denoise.bent", Packing::Normal},
                        {"direct.radiance", Packing::Light},    {"direct.all", Packing::Light},
                        {"feedback.radiance", Packing::Light},  {"resolution.radiance", Packing::Light},
                        {"denoise.light", Packing::Light},      {"denoise.ambient", Packing::Light},
                        {"denoise.state", Packing::State},      {"feedback.nearest", Packing::Depth},
                        {"feedback.owner", Packing::Pixel}};

constexpr uint32_t no_direction = 0x80008000u;  // NO_BENT
constexpr uint32_t nothing_landed = ~0u;        // feedback_clear.frag

Unpacked unpack(Packing packing, graph::Size size, uint32_t bits) {
  switch (packing) {
    case Packing::Normal: {
      if (bits == no_direction) return {"view-space direction", {}};
      const float x = float(int16_t(bits & 0xffff)) / 32767, y = float(int16_t(bits >> 16)) / 32767;
      glm::vec3 n(x, y, 1 - std::abs(x) - std::abs(y));
      const float fold = std::max(-n.z, 0.0f);
      n.x -= std::copysign(fold, n.x);
      n.y -= std::copysign(fold, n.y);
      n = glm::normalize(n);
      return {"view-space direction", {n.x, n.y, n.z}};
    }
    case Packing::Light: {
      const float scale = std::ldexp(1.0f, int(bits >> 27) - 24);
      return {"RGB9E5", {float(bits & 511) * scale, float(bits >> 9 & 511) * scale, float(bits >> 18 & 511) * scale}};
    }
    case Packing::State:
      return {"visibility, variance", {float(bits & 0xffff) / 16384 - 1, std::bit_cast<float>(bits & 0xffff0000u)}};
    case Packing::Depth:
      return {"depth, m", bits == nothing_landed ? std::vector<float>{} : std::vector{std::bit_cast<float>(bits)}};
    case Packing::Pixel:
      return {"pixel of the last frame", bits == nothing_landed ? std::vector<float>{}
                                                                : std::vector{float(bits % std::max(size.width, 1u)),
                                                                              float(bits / std::max(size.width, 1u))}};
  }
  return {"", {}};
}

}  // namespace

std::optional<Unpacked> unpack_texel(std::string_view image, graph::Size size, uint32_t bits) {
  for (const Row& row : rows)
    if (row.image == image) return unpack(row.packing, size, bits);
  return std::nullopt;
}

bool shows_view(std::string_view image) {
  return !image.starts_with("shadow.");
}

}  // namespace nf::passes
