// The environment's uploads and the reflectance table.
#include "environment.h"

#include <array>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/packing.hpp>

#include "gpu/upload.h"
#include "scene/environment_light.h"

namespace nf::passes {
namespace {

constexpr VkFormat half4 = VK_FORMAT_R16G16B16A16_SFLOAT;

std::vector<uint64_t> to_half(std::span<const glm::vec3> texels) {
  std::vector<uint64_t> out;
  out.reserve(texels.size());
  for (const glm::vec3& t : texels) out.push_back(glm::packHalf4x16(glm::vec4(glm::min(t, 65504.0f), 1)));
  return out;
}

gpu::Image upload_map(gpu::Device& device, const scene::Environment& map) {
  const uint32_t most = device.facts.max_image_size;
  if (map.width > most || map.height > most)
    fail(Exit::Gpu, "environment '{}' is {}x{}, and {} takes {} texels a side at most; scale it down", map.file,
         map.width, map.height, device.info.name, most);
  const std::vector<uint64_t> texels = to_half(map.texels);
  const gpu::ImagePart part{0, 0, std::as_bytes(std::span(texels))};
  return gpu::upload_image(device, {.extent = {map.width, map.height}, .format = half4}, {&part, 1}, "environment.map",
                           gpu::WholeView::Flat);
}

gpu::Image upload_cube(gpu::Device& device, const scene::PrefilteredCube& cube) {
  std::vector<std::vector<uint64_t>> mips;
  for (const std::vector<glm::vec3>& texels : cube.mips) mips.push_back(to_half(texels));
  std::vector<gpu::ImagePart> parts;
  for (uint32_t mip = 0; mip < mips.size(); ++mip) {
    const std::span<const uint64_t> all(mips[mip]);
    for (uint32_t face = 0; face < 6; ++face)
      parts.push_back({mip, face, std::as_bytes(all.subspan(face * all.size() / 6, all.size() / 6))});
  }
  const gpu::ImageInfo info{
      .extent = {cube.side, cube.side}, .format = half4, .mips = uint32_t(mips.size()), .layers = 6};
  return gpu::upload_image(device, info, parts, "environment.cube", gpu::WholeView::Cube);
}

}  // namespace

EnvironmentMaps create_environment(gpu::Device& device, const scene::Environment& environment) {
  EnvironmentMaps maps;
  if (environment.kind == scene::EnvironmentKind::Constant) return maps;
  const bool is_map = environment.kind == scene::EnvironmentKind::Map;
  maps.map = upload_map(device, is_map ? environment : scene::as_map(environment));
  maps.cube = upload_cube(device, scene::prefilter(environment));
  EnvironmentBlock& b = maps.block;
  const scene::Harmonics sh = scene::to_polynomial(scene::irradiance_over_pi(scene::project(environment)));
  const std::array<glm::vec3*, 9> members = {&b.irradiance_0, &b.irradiance_1, &b.irradiance_2,
                                             &b.irradiance_3, &b.irradiance_4, &b.irradiance_5,
                                             &b.irradiance_6, &b.irradiance_7, &b.irradiance_8};
  for (size_t i = 0; i < 9; ++i) *members[i] = sh[i];
  b.map_turn = environment.rotation / (2 * glm::pi<float>());
  b.last_mip = float(maps.cube.info.mips - 1);
  return maps;
}

void destroy(gpu::Device& device, EnvironmentMaps& maps) {
  gpu::destroy(device, maps.map);
  gpu::destroy(device, maps.cube);
}

void feed_environment(graph::Graph& graph, graph::PassBuilder& pass, const gpu::ShaderInterface& interface,
                      const EnvironmentMaps& maps) {
  if (interface.find("environment_map")) pass.in("environment_map", graph.import("environment.map", maps.map));
  if (interface.find("environment_cube")) pass.in("environment_cube", graph.import("environment.cube", maps.cube));
  if (interface.find(EnvironmentBlock::table().prefix)) pass.params(maps.block);
}

std::vector<glm::vec2> reflectance_table() {
  constexpr uint32_t side = reflectance_side, samples = 512;
  constexpr float pi = 3.14159265358979f;
  std::vector<glm::vec2> table;
  for (uint32_t row = 0; row < side; ++row)
    for (uint32_t column = 0; column < side; ++column) {
      const float n_v = (float(column) + 0.5f) / side, roughness = (float(row) + 0.5f) / side;
      const float a2 = roughness * roughness * roughness * roughness;
      const glm::vec3 v(std::sqrt(1 - n_v * n_v), 0, n_v);
      glm::vec2 sum(0);
      for (uint32_t i = 0; i < samples; ++i) {
        // Half vectors distributed as D(h) n.h, along a golden-ratio spiral.
        const float u = (float(i) + 0.5f) / samples, phi = 2 * pi * 0.618033988749895f * float(i);
        const float cosine = std::sqrt((1 - u) / (1 + (a2 - 1) * u)), sine = std::sqrt(1 - cosine * cosine);
        const glm::vec3 h(sine * std::cos(phi), sine * std::sin(phi), cosine);
        const float v_h = glm::dot(v, h);
        const float n_l = 2 * v_h * h.z - v.z;
        if (n_l <= 0 || v_h <= 0) continue;
        const float smith =
            0.5f / (n_v * std::sqrt(n_l * n_l * (1 - a2) + a2) + n_l * std::sqrt(n_v * n_v * (1 - a2) + a2));
        const float weight = 4 * smith * n_l * v_h / h.z;  // f n.l / pdf, without Fresnel
        const float fresnel = std::pow(1 - v_h, 5.0f);
        sum += weight * glm::vec2(1 - fresnel, fresnel);
      }
      table.push_back(sum / float(samples));
    }
  return table;
}

}  // namespace nf::passes
