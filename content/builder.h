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
#include <functional>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <span>
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
using ObjectId = Handle<struct ObjectTag>;

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
  std::vector<vec3> normal;
  std::vector<vec4> tangent;
  std::vector<vec2> uv;
  std::vector<uint32_t> index;
};

// A point of a curved surface: where it is, and where in the material's pictures.
struct SurfacePoint {
  vec3 position;
  vec2 uv;
};

// The two joints of a skin that a vertex follows, the second by `blend`.
struct JointPair {
  uint32_t first = 0, second = 0;
  float blend = 0;
};

class Builder {
 public:
  MaterialId material(const Material& material);
  // Embedded as PNG. Whether it is sRGB follows from its use, as glTF has it: base colour and emission are.
  PictureId picture(std::string name, const image::Image8& picture);

  // What follows goes into a new node of this name, below `parent` if one is given. Without a call everything goes into
  // one node called "object".
  ObjectId object(std::string name, const Placement& placement = {}, ObjectId parent = {});
  // A node that shows what `of` shows, elsewhere. What follows still goes into the object before.
  ObjectId copy(std::string name, ObjectId of, const Placement& placement, ObjectId parent = {});

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

  // A smooth patch of columns x rows faces over s, t in [0,1]; seen from the front s runs right and t up. Vertices are
  // shared; normals and tangents come from differences of `point`, so that it should be smooth inside.
  void surface(uint32_t columns, uint32_t rows, const std::function<SurfacePoint(float s, float t)>& point,
               MaterialId material);
  // Turns a line of (radius, height) points about the y axis through `foot`, seen from outside for a line that rises.
  // Smooth, but for corners of more than 35 degrees. The picture goes round uv_repeat.x times, and uv_repeat.y times
  // along a metre.
  void revolve(std::span<const vec2> line, uint32_t sides, vec3 foot, MaterialId material, vec2 uv_repeat = vec2(1));

  // Moves an object's node: its translation or rotation at rising times (s), linear between them.
  void animate_translation(ObjectId object, const std::vector<float>& times, const std::vector<vec3>& values);
  void animate_rotation(ObjectId object, const std::vector<float>& times, const std::vector<quat>& values);
  // Hangs an object's vertices on joints, as they stand now: joints are objects, counted from 0 in the list, and `pair`
  // says which two a vertex (a position in world space) follows. The object must stand at the origin, unturned.
  void skin(ObjectId object, const std::vector<ObjectId>& joints, const std::function<JointPair(vec3)>& pair);

  void camera(std::string name, vec3 eye, vec3 target, float vfov_deg, vec3 up = {0, 1, 0}, float near = 0.05f,
              float far = 100);
  // direction is the way the light travels; irradiance on a facing surface in W/m2.
  void directional_light(vec3 direction, float irradiance, vec3 color = vec3(1));
  // intensity in W/sr.
  void point_light(vec3 position, float intensity, vec3 color = vec3(1), ObjectId parent = {});
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
    ObjectId parent, mesh_of;
  };
  struct Track {
    ObjectId object;
    bool rotation;
    std::vector<float> times, values;  // values: 3 or 4 (x, y, z, w) floats a key
  };
  struct Skin {
    ObjectId object;
    std::vector<ObjectId> joints;
    std::function<JointPair(vec3)> pair;
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
    ObjectId parent{};
  };
  struct Picture {
    std::string name;
    std::vector<uint8_t> png;
  };

  void check(ObjectId object) const;
  Primitive& primitive(MaterialId material);
  void triangle_fan(const vec3* corner, const vec2* uv, uint32_t count, MaterialId material);
  void box_faces(vec3 center, vec3 half_extent, float rotation_y, bool inwards, MaterialId material);

  std::vector<Material> materials_;
  std::vector<Picture> pictures_;
  std::vector<Object> objects_;
  size_t current_ = 0;  // the object that shapes go into
  std::vector<Track> tracks_;
  std::vector<Skin> skins_;
  std::vector<Camera> cameras_;
  std::vector<Light> lights_;
};

}  // namespace nf::content
