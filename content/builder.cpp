// Shapes into flat-shaded triangles.
#include "builder.h"

#include <array>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "image/file.h"

namespace nf::content {
namespace {

// glTF's cameras and lights look down their node's -Z.
quat rotation_towards(vec3 direction, vec3 up) {
  NF_CHECK(glm::length(direction) > 0, "a camera or light without a direction");
  direction = glm::normalize(direction);
  if (glm::length(glm::cross(direction, up)) < 1e-3f * glm::length(up)) {
    up = std::abs(direction.y) > 0.9f ? vec3(0, 0, -1) : vec3(0, 1, 0);
  }
  return glm::quatLookAt(direction, up);
}

vec3 turned(vec3 v, float rotation_y) {
  const float c = std::cos(rotation_y), s = std::sin(rotation_y);
  return {c * v.x + s * v.z, v.y, c * v.z - s * v.x};
}

}  // namespace

MaterialId Builder::material(const Material& material) {
  for (PictureId picture : {material.base_color_picture, material.normal_picture, material.metallic_roughness_picture,
                            material.emissive_picture}) {
    NF_CHECK(!picture || picture.id < pictures_.size(), "material '{}' uses unknown picture {}", material.name,
             picture.id);
  }
  materials_.push_back(material);
  if (material.name.empty()) materials_.back().name = fmt::format("material{}", materials_.size() - 1);
  return {uint16_t(materials_.size() - 1)};
}

PictureId Builder::picture(std::string name, const image::Image8& picture) {
  pictures_.push_back({std::move(name), image::encode_png(picture)});
  return {uint16_t(pictures_.size() - 1)};
}

void Builder::check(ObjectId object) const {
  NF_CHECK(object.id < objects_.size(), "unknown object {}", object.id);
}

ObjectId Builder::object(std::string name, const Placement& placement, ObjectId parent) {
  if (parent) check(parent);
  current_ = objects_.size();
  objects_.push_back({std::move(name), placement, {}, parent, {}});
  return {uint16_t(current_)};
}

ObjectId Builder::copy(std::string name, ObjectId of, const Placement& placement, ObjectId parent) {
  check(of);
  if (parent) check(parent);
  objects_.push_back({std::move(name), placement, {}, parent, of});
  return {uint16_t(objects_.size() - 1)};
}

Primitive& Builder::primitive(MaterialId material) {
  NF_CHECK(material.id < materials_.size(), "unknown material {}", material.id);
  if (objects_.empty()) object("object");
  auto& primitives = objects_[current_].primitives;
  for (Primitive& primitive : primitives) {
    if (primitive.material == material) return primitive;
  }
  return primitives.emplace_back(Primitive{.material = material});
}

// A convex planar face, its corners counter-clockwise. The tangent assumes that u runs from corner 0 to corner 1 and
// that the picture is not mirrored, so handedness is +1: cross(normal, tangent) is up in the picture.
void Builder::triangle_fan(const vec3* corner, const vec2* uv, uint32_t count, MaterialId material) {
  Primitive& to = primitive(material);
  const vec3 cross = glm::cross(corner[1] - corner[0], corner[2] - corner[0]);
  NF_CHECK(glm::length(cross) > 0, "a face without an area at ({}, {}, {})", corner[0].x, corner[0].y, corner[0].z);
  const vec3 normal = glm::normalize(cross), tangent = glm::normalize(corner[1] - corner[0]);
  const uint32_t base = uint32_t(to.position.size());
  for (uint32_t i = 0; i < count; ++i) {
    to.position.push_back(corner[i]);
    to.normal.push_back(normal);
    to.tangent.emplace_back(tangent, 1.0f);
    to.uv.push_back(uv[i]);
  }
  for (uint32_t i = 2; i < count; ++i) to.index.insert(to.index.end(), {base, base + i - 1, base + i});
}

void Builder::quad(vec3 p0, vec3 p1, vec3 p2, vec3 p3, MaterialId material, vec2 uv_repeat) {
  grid(p0, p1, p2, p3, 1, 1, material, uv_repeat);
}

void Builder::grid(vec3 p0, vec3 p1, vec3 p2, vec3 p3, uint32_t columns, uint32_t rows, MaterialId material,
                   vec2 uv_repeat) {
  // glTF's v = 0 is the picture's top row.
  auto point = [&](uint32_t column, uint32_t row, vec2& uv) {
    const float s = float(column) / float(columns), t = float(row) / float(rows);
    uv = vec2(s, 1 - t) * uv_repeat;
    return glm::mix(glm::mix(p0, p1, s), glm::mix(p3, p2, s), t);
  };
  for (uint32_t row = 0; row < rows; ++row) {
    for (uint32_t column = 0; column < columns; ++column) {
      std::array<vec2, 4> uv;
      const std::array corner{point(column, row, uv[0]), point(column + 1, row, uv[1]),
                              point(column + 1, row + 1, uv[2]), point(column, row + 1, uv[3])};
      triangle_fan(corner.data(), uv.data(), 4, material);
    }
  }
}

void Builder::box_faces(vec3 center, vec3 half_extent, float rotation_y, bool inwards, MaterialId material) {
  // Outward normal and the face's right-hand direction; up completes them: right x up = normal.
  struct Side {
    vec3 normal, right;
  };
  static constexpr std::array<Side, 6> sides{{
      {vec3(0, 0, 1), vec3(1, 0, 0)},
      {vec3(0, 0, -1), vec3(-1, 0, 0)},
      {vec3(1, 0, 0), vec3(0, 0, -1)},
      {vec3(-1, 0, 0), vec3(0, 0, 1)},
      {vec3(0, 1, 0), vec3(1, 0, 0)},
      {vec3(0, -1, 0), vec3(1, 0, 0)},
  }};
  for (const Side& side : sides) {
    const vec3 up = glm::cross(side.normal, side.right);
    const vec3 right = inwards ? -side.right : side.right;
    auto point = [&](float s, float t) {
      return center + turned(half_extent * (side.normal + s * right + t * up), rotation_y);
    };
    quad(point(-1, -1), point(1, -1), point(1, 1), point(-1, 1), material);
  }
}

void Builder::box(vec3 center, vec3 half_extent, float rotation_y, MaterialId material) {
  box_faces(center, half_extent, rotation_y, false, material);
}

void Builder::room(vec3 center, vec3 half_extent, MaterialId material) {
  box_faces(center, half_extent, 0, true, material);
}

void Builder::cylinder(vec3 from, vec3 to, float radius, uint32_t sides, MaterialId material) {
  NF_CHECK(sides >= 3, "a cylinder of {} sides", sides);
  const vec3 axis = glm::normalize(to - from);
  const vec3 x = glm::normalize(glm::cross(axis, std::abs(axis.x) < 0.9f ? vec3(1, 0, 0) : vec3(0, 0, 1)));
  const vec3 y =
      glm::cross(axis, x);  // x, y, axis: right-handed, so rising angles run counter-clockwise seen from `to`
  std::vector<vec3> bottom(sides), top(sides);
  std::vector<vec2> uv(sides);
  for (uint32_t i = 0; i < sides; ++i) {
    const float angle = 2 * std::numbers::pi_v<float> * float(i) / float(sides);
    const vec3 offset = radius * (std::cos(angle) * x + std::sin(angle) * y);
    // The bottom's corners run the other way, so that its front is outside.
    bottom[(sides - i) % sides] = from + offset;
    top[i] = to + offset;
    uv[i] = vec2(0.5f + 0.5f * std::cos(angle), 0.5f - 0.5f * std::sin(angle));
  }
  for (uint32_t i = 0; i < sides; ++i) {
    const uint32_t next = (i + 1) % sides;
    const std::array corner{bottom[(sides - i) % sides], bottom[(sides - next) % sides], top[next], top[i]};
    const float u0 = float(i) / float(sides), u1 = float(i + 1) / float(sides);
    const std::array side_uv{vec2(u0, 1), vec2(u1, 1), vec2(u1, 0), vec2(u0, 0)};
    triangle_fan(corner.data(), side_uv.data(), 4, material);
  }
  triangle_fan(bottom.data(), uv.data(), sides, material);
  triangle_fan(top.data(), uv.data(), sides, material);
}

void Builder::camera(std::string name, vec3 eye, vec3 target, float vfov_deg, vec3 up, float near, float far) {
  const Placement placement{.translation = eye, .rotation = rotation_towards(target - eye, up)};
  cameras_.push_back({std::move(name), placement, glm::radians(vfov_deg), near, far});
}

void Builder::directional_light(vec3 direction, float irradiance, vec3 color) {
  lights_.push_back({LightKind::Directional, {.rotation = rotation_towards(direction, {0, 1, 0})}, irradiance, color});
}

void Builder::point_light(vec3 position, float intensity, vec3 color, ObjectId parent) {
  if (parent) check(parent);
  lights_.push_back({LightKind::Point, {.translation = position}, intensity, color, 0, 0, parent});
}

void Builder::spot_light(vec3 position, vec3 direction, float intensity, float inner_deg, float outer_deg, vec3 color) {
  const Placement placement{.translation = position, .rotation = rotation_towards(direction, {0, 1, 0})};
  lights_.push_back({LightKind::Spot, placement, intensity, color, glm::radians(inner_deg), glm::radians(outer_deg)});
}

void Builder::animate_translation(ObjectId object, const std::vector<float>& times, const std::vector<vec3>& values) {
  check(object);
  NF_CHECK(times.size() == values.size() && !times.empty(), "{} times, {} values", times.size(), values.size());
  Track track{object, false, times, {}};
  for (const vec3& v : values) track.values.insert(track.values.end(), {v.x, v.y, v.z});
  tracks_.push_back(std::move(track));
}

void Builder::animate_rotation(ObjectId object, const std::vector<float>& times, const std::vector<quat>& values) {
  check(object);
  NF_CHECK(times.size() == values.size() && !times.empty(), "{} times, {} values", times.size(), values.size());
  Track track{object, true, times, {}};
  for (const quat& q : values) track.values.insert(track.values.end(), {q.x, q.y, q.z, q.w});
  tracks_.push_back(std::move(track));
}

void Builder::skin(ObjectId object, const std::vector<ObjectId>& joints, const std::function<JointPair(vec3)>& pair) {
  check(object);
  for (const ObjectId joint : joints) check(joint);
  skins_.push_back({object, joints, pair});
}

void Builder::save(const std::filesystem::path& path) const {
  image::write_file(path, glb());
}

}  // namespace nf::content
