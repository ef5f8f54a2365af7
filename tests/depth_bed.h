// An analytic depth buffer for testing screen-space estimators without a renderer: rectangles, spheres and boxes in
// world space seen through a perspective camera, answering each texel by casting a ray through its centre.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <utility>
#include <vector>

namespace bed {

// A parallelogram `corner + a u + b v`, a, b in [0, 1]; two-sided, its normal is turned to the eye.
struct Quad {
  glm::dvec3 corner, u, v;
  glm::vec3 radiance{0};
};

struct Ball {
  glm::dvec3 centre;
  double radius;
  glm::vec3 radiance{0};
};

// Axis-aligned.
struct Box {
  glm::dvec3 low, high;
  glm::vec3 radiance{0};
};

struct Hit {
  double t = 1e30;
  glm::dvec3 normal{0};
  glm::vec3 radiance{0};
};

struct Scene {
  std::vector<Quad> quads;
  std::vector<Ball> balls;
  std::vector<Box> boxes;

  // Nearest surface along origin + t direction, t > 0.
  Hit cast(glm::dvec3 origin, glm::dvec3 direction) const {
    Hit hit;
    auto offer = [&](double t, glm::dvec3 normal, glm::vec3 radiance) {
      if (t > 1e-9 && t < hit.t) hit = {t, normal, radiance};
    };
    for (const Quad& quad : quads) {
      glm::dvec3 normal = glm::normalize(glm::cross(quad.u, quad.v));
      double t = glm::dot(quad.corner - origin, normal) / glm::dot(direction, normal);
      glm::dvec3 at = origin + t * direction - quad.corner;
      double a = glm::dot(at, quad.u) / glm::dot(quad.u, quad.u), b = glm::dot(at, quad.v) / glm::dot(quad.v, quad.v);
      if (a >= 0 && a <= 1 && b >= 0 && b <= 1) {
        offer(t, glm::dot(direction, normal) < 0 ? normal : -normal, quad.radiance);
      }
    }
    for (const Ball& ball : balls) {
      glm::dvec3 to = origin - ball.centre;
      double a = glm::dot(direction, direction), b = glm::dot(to, direction);
      double root = b * b - a * (glm::dot(to, to) - ball.radius * ball.radius);
      if (root < 0) continue;
      double t = (-b - std::sqrt(root)) / a;
      offer(t, (to + t * direction) / ball.radius, ball.radiance);
    }
    for (const Box& box : boxes) {
      double enter = -1e30, leave = 1e30;
      glm::dvec3 normal(0);
      for (int axis = 0; axis < 3; ++axis) {
        double first = (box.low[axis] - origin[axis]) / direction[axis];
        double last = (box.high[axis] - origin[axis]) / direction[axis];
        if (first > last) std::swap(first, last);
        if (first > enter) {
          enter = first;
          normal = glm::dvec3(0);
          normal[axis] = direction[axis] < 0 ? 1 : -1;
        }
        leave = std::min(leave, last);
      }
      if (enter < leave) offer(enter, normal, box.radiance);
    }
    return hit;
  }
};

struct Camera {
  glm::dvec3 position{0, 0, 0};
  glm::dvec3 target{0, 0, -1};
  double fov_degrees = 90;  // vertical
  glm::ivec2 size{1024, 1024};

  // Columns: right, up, back.
  glm::dmat3 axes() const {
    glm::dvec3 back = glm::normalize(position - target);
    glm::dvec3 up = std::abs(back.y) > 0.999 ? glm::dvec3(0, 0, -1) : glm::dvec3(0, 1, 0);
    glm::dvec3 right = glm::normalize(glm::cross(up, back));
    return glm::dmat3(right, glm::cross(back, right), back);
  }
  glm::dvec2 tangents() const {
    double ty = std::tan(fov_degrees * 3.14159265358979323846 / 360);
    return {ty * size.x / size.y, ty};
  }
  // The texel that shows a world point.
  glm::ivec2 texel_of(glm::dvec3 world) const {
    glm::dvec3 p = glm::transpose(axes()) * (world - position);
    glm::dvec2 t = tangents();
    return glm::ivec2(int(std::floor((p.x / -p.z / t.x + 1) / 2 * size.x)),
                      int(std::floor((1 - p.y / -p.z / t.y) / 2 * size.y)));
  }
};

struct Texel {
  float depth = 0;  // linear, 0 = background
  glm::vec3 normal{0, 0, 1};
  glm::vec3 radiance{0};
  glm::dvec3 world{0};
};

struct Bed {
  Scene scene;
  Camera camera;
  mutable int outside = 0;  // fetches off the screen: must stay 0

  Texel texel(glm::ivec2 p) const {
    if (p.x < 0 || p.y < 0 || p.x >= camera.size.x || p.y >= camera.size.y) ++outside;
    glm::dvec2 t = camera.tangents();
    glm::dmat3 axes = camera.axes();
    glm::dvec3 ray((2 * (p.x + 0.5) / camera.size.x - 1) * t.x, (1 - 2 * (p.y + 0.5) / camera.size.y) * t.y, -1);
    Hit hit = scene.cast(camera.position, axes * ray);
    if (hit.t > 1e29) return {};
    return {float(hit.t), glm::vec3(glm::transpose(axes) * hit.normal), hit.radiance,
            camera.position + axes * ray * hit.t};
  }
};

}  // namespace bed
