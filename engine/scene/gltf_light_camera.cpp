// Cameras and KHR_lights_punctual lights, placed by their nodes: both look down the node's -Z. Scale does not matter.
#include <cmath>

#include "scene/gltf_import.h"
#include "scene/text.h"
#include "scene/update.h"

namespace nf::scene::gltf {

namespace {

constexpr float pi = 3.14159265f;

void import_camera(Importer& importer, const tinygltf::Camera& source, const std::string& node_name, uint32_t node) {
  const mat4& world = importer.scene.nodes.world[node];
  const std::string name = one_line(source.name.empty() ? node_name : source.name);
  const tinygltf::PerspectiveCamera& lens = source.perspective;
  if (source.type != "perspective") {
    importer.warn_once("orthographic cameras are skipped");
    return;
  }
  Camera camera;
  camera.name = name.empty() ? fmt::format("camera {}", importer.scene.cameras.size()) : name;
  if (!(lens.yfov > 1e-4 && lens.yfov < 3.1415)) refuse("the camera '{}' has a yfov of {}", camera.name, lens.yfov);
  if (!(lens.znear > 0)) refuse("the camera '{}' has a znear of {}", camera.name, lens.znear);
  camera.vfov = float(lens.yfov);
  camera.near = std::max(float(lens.znear), 1e-6f);
  camera.far = lens.zfar > lens.znear ? float(lens.zfar) : std::max(camera.far, 2 * camera.near);
  camera.node = node;
  if (!place(world, camera)) {
    importer.warn_once(fmt::format("the camera '{}' is skipped: its node's scale is zero", camera.name));
    return;
  }
  importer.scene.cameras.push_back(std::move(camera));
}

void import_light(Importer& importer, const tinygltf::Light& source, size_t row, uint32_t node) {
  const mat4& world = importer.scene.nodes.world[node];
  const std::string where = describe("light", row, one_line(source.name));
  vec3 color(1);
  for (int i = 0; i < 3 && source.color.size() == 3; ++i) color[i] = std::max(0.f, float(source.color[size_t(i)]));
  const float intensity = float(source.intensity);
  if (!(intensity >= 0)) refuse("{} has the intensity {}", where, intensity);
  if (!(glm::length(vec3(world[2])) > 1e-12f) && source.type != "point") {
    importer.warn_once(fmt::format("{} is skipped: its node's scale is zero", where));
    return;
  }
  if (source.type == "directional") {
    DirectionalLight light{.color = color, .irradiance = intensity, .node = node};
    place(world, light);
    importer.scene.directional.push_back(light);
    return;
  }
  PunctualLight light{.node = node};
  place(world, light);
  light.color = color;
  light.intensity = intensity;
  light.range = std::max(0.f, float(source.range));
  if (source.type == "spot") {
    const float inner = float(source.spot.innerConeAngle), outer = float(source.spot.outerConeAngle);
    if (!(inner >= 0 && inner <= outer && outer > 0 && outer <= pi / 2 + 1e-4f)) {
      refuse("{} has the cone angles {} and {}", where, inner, outer);
    }
    light.inner_cone = inner;
    light.outer_cone = outer;
  } else if (source.type != "point") {
    refuse("{} has the unknown type '{}'", where, one_line(source.type, 40));
  }
  importer.scene.punctual.push_back(light);
}

}  // namespace

void import_cameras(Importer& importer, std::span<const uint32_t> file_node) {
  for (size_t row = 0; row < file_node.size(); ++row) {
    const tinygltf::Node& node = importer.model.nodes[file_node[row]];
    if (node.camera < 0) continue;
    import_camera(importer, importer.model.cameras.at(size_t(node.camera)), node.name, uint32_t(row));
  }
}

void import_lights(Importer& importer, std::span<const uint32_t> file_node) {
  for (size_t row = 0; row < file_node.size(); ++row) {
    const tinygltf::Node& node = importer.model.nodes[file_node[row]];
    const auto extension = node.extensions.find("KHR_lights_punctual");
    if (extension == node.extensions.end()) continue;
    const size_t light = size_t(extension->second.Get("light").GetNumberAsInt());
    import_light(importer, importer.model.lights.at(light), light, uint32_t(row));
  }
}

}  // namespace nf::scene::gltf
