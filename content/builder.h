// A small scene as a value, and the glTF 2.0 binary it is written as. Right-handed, +Y up, metres, as glTF has it. The
// generated scenes and the tests' one-off scenes are made with it:
//
//   Builder b;
//   auto white = b.material({.base_color = vec3(0.8f)});
//   b.quad({-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}, white);
//   b.directional_light({0, -1, 0}, 3);
//   b.camera("front", {0, 1, 3}, {0, 0, 0}, 60);
//   b.save("floor.glb");
//
// Same calls, same bytes. Broken calls (a degenerate face, an unknown handle) stop the program.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <string>
#include <vector>

#include "core/handle.h"
#include "image/image.h"

namespace nf::content {

using glm::quat;
using glm::vec2;
using glm::vec3;
using glm::vec4;

using MaterialId = Handle<struct MaterialTag>;
using PictureId = Handle<struct PictureTag>;

struct Material {
  std::string name;
  vec3 base_color{1};
  float alpha = 1;
  float metallic = 0, roughness = 1;
  vec3 emissive{0};        // radiance; beyond 1 through KHR_materials_emissive_strength
  float alpha_cutoff = 0;  // above 0: alpha-masked
  bool double_sided = false;
  float normal_scale = 1;
  PictureId base_color_picture, normal_picture, metallic_roughness_picture, emissive_picture;
};

// Where an object's node stands; its geometry is given in the node's space.
struct Placement {
  vec3 translation{0};
  quat rotation{1, 0, 0, 0};  // w, x, y, z
  vec3 scale{1};
};

// One primitive: the triangles of one object with one material.
struct Primitive {
  MaterialId material;
  std::vector<vec3> position;
  std::vector<vec3> normal;  // flat: vertices are never shared between faces
  std::vector<vec4> tangent;
  std::vector<vec2> uv;
  std::vector<uint32_t> index;
};

class Builder {
 public:
  MaterialId material(const Material& material);
  // Embedded as PNG. Whether it is sRGB follows from its use, as glTF has it: base colour and emission are.
  PictureId picture(std::string name, const image::Image8& picture);

  // What follows goes into a new node of this name. Without a call everything goes into one node called "object".
  void object(std::string name, const Placement& placement = {});

  // Corners run counter-clockwise as seen from the front, p0 at the lower left of the picture; the picture is repeated
  // uv_repeat times. Planar.
  void quad(vec3 p0, vec3 p1, vec3 p2, vec3 p3, MaterialId material, vec2 uv_repeat = vec2(1));
  // The same in columns x rows faces, for tests of many triangles.
  void grid(vec3 p0, vec3 p1, vec3 p2, vec3 p3, uint32_t columns, uint32_t rows, MaterialId material,
            vec2 uv_repeat = vec2(1));
  // Turned about +Y by rotation_y radians; seen from outside.
  void box(vec3 center, vec3 half_extent, float rotation_y, MaterialId material);
  // A box seen from inside.
  void room(vec3 center, vec3 half_extent, MaterialId material);
  // A closed, faceted cylinder.
  void cylinder(vec3 from, vec3 to, float radius, uint32_t sides, MaterialId material);

  void camera(std::string name, vec3 eye, vec3 target, float vfov_deg, vec3 up = {0, 1, 0}, float near = 0.05f,
              float far = 100);
  // direction is the way the light travels; irradiance on a facing surface in W/m2.
  void directional_light(vec3 direction, float irradiance, vec3 color = vec3(1));
  // intensity in W/sr.
  void point_light(vec3 position, float intensity, vec3 color = vec3(1));
  // Half angles of the cone in degrees.
  void spot_light(vec3 position, vec3 direction, float intensity, float inner_deg, float outer_deg,
                  vec3 color = vec3(1));

  std::vector<uint8_t> glb() const;
  // Throws nf::Error (Exit::Output).
  void save(const std::filesystem::path& path) const;

 private:
  friend class Writer;

  struct Object {
    std::string name;
    Placement placement;
    std::vector<Primitive> primitives;
  };
  struct Camera {
    std::string name;
    Placement placement;
    float vfov, near, far;
  };
  enum class LightKind : uint8_t { Directional, Point, Spot };
  struct Light {
    LightKind kind;
    Placement placement;
    float intensity;
    vec3 color;
    float inner = 0, outer = 0;  // radians
  };
  struct Picture {
    std::string name;
    std::vector<uint8_t> png;
  };

  Primitive& primitive(MaterialId material);
  void triangle_fan(const vec3* corner, const vec2* uv, uint32_t count, MaterialId material);
  void box_faces(vec3 center, vec3 half_extent, float rotation_y, bool inwards, MaterialId material);

  std::vector<Material> materials_;
  std::vector<Picture> pictures_;
  std::vector<Object> objects_;
  std::vector<Camera> cameras_;
  std::vector<Light> lights_;
};

}  // namespace nf::content
