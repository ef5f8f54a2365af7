// Peaks: maxima of a coordinate over the graph of a mesh's edges.
#include "scene/peaks.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "scene/deform.h"

namespace nf::scene {
namespace {

// Level, and at one place, up to this share of the scene's size.
constexpr float tolerance = 1e-5f;

uint32_t root_of(std::vector<uint32_t>& parent, uint32_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

// Row of the first vertex at the same place, for every vertex.
std::vector<uint32_t> weld(std::span<const vec3> position) {
  std::vector<uint32_t> order(position.size()), first(position.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto less = [&](uint32_t i, uint32_t j) {
    for (int c = 0; c < 3; ++c)
      if (position[i][c] != position[j][c]) return position[i][c] < position[j][c];
    return i < j;
  };
  std::sort(order.begin(), order.end(), less);
  for (size_t i = 0; i < order.size(); ++i)
    first[order[i]] = i && position[order[i]] == position[order[i - 1]] ? first[order[i - 1]] : order[i];
  return first;
}

// Middles of the level pieces of surface with nothing higher next to them.
std::vector<vec3> peaks_along(std::span<const vec3> position, std::span<const uint32_t> edges, int axis, float sign,
                              float level) {
  std::vector<uint32_t> parent(position.size());
  std::iota(parent.begin(), parent.end(), 0u);
  const auto height = [&](uint32_t i) { return sign * position[i][axis]; };
  for (size_t e = 0; e < edges.size(); e += 2) {
    const uint32_t a = edges[e], b = edges[e + 1];
    if (std::abs(height(a) - height(b)) <= level) parent[root_of(parent, a)] = root_of(parent, b);
  }
  std::vector<uint8_t> peak(position.size(), 0);
  for (const uint32_t i : edges) peak[root_of(parent, i)] = 1;
  for (size_t e = 0; e < edges.size(); e += 2) {
    const uint32_t a = edges[e], b = edges[e + 1];
    if (std::abs(height(a) - height(b)) > level) peak[root_of(parent, height(a) < height(b) ? a : b)] = 0;
  }
  std::vector<uint32_t> row(position.size(), none);
  std::vector<Bounds> boxes;
  for (uint32_t i = 0; i < position.size(); ++i) {
    const uint32_t r = root_of(parent, i);
    if (!peak[r]) continue;
    if (row[r] == none) {
      row[r] = uint32_t(boxes.size());
      boxes.push_back({position[i], position[i]});
    }
    Bounds& box = boxes[row[r]];
    box.min = glm::min(box.min, position[i]), box.max = glm::max(box.max, position[i]);
  }
  std::vector<vec3> middles;
  for (const Bounds& box : boxes) middles.push_back((box.min + box.max) * 0.5f);
  return middles;
}

// A k-d tree in place: of every range the middle row splits it at its own coordinate.
class Nearest {
 public:
  explicit Nearest(std::vector<vec3>& points) : points_(points) { build(0, points.size(), 0); }
  // Squared distance from `p` to the nearest that is further than `least`; infinite where there is none.
  float from(const vec3& p, float least) const {
    float best = std::numeric_limits<float>::infinity();
    search(0, points_.size(), 0, p, least * least, best);
    return best;
  }

 private:
  void build(size_t first, size_t last, int axis) {
    if (last - first < 2) return;
    const size_t middle = (first + last) / 2;
    const auto at = [&](size_t i) { return points_.begin() + ptrdiff_t(i); };
    std::nth_element(at(first), at(middle), at(last),
                     [axis](const vec3& a, const vec3& b) { return a[axis] < b[axis]; });
    build(first, middle, (axis + 1) % 3);
    build(middle + 1, last, (axis + 1) % 3);
  }
  void search(size_t first, size_t last, int axis, const vec3& p, float least, float& best) const {
    if (first >= last) return;
    const size_t middle = (first + last) / 2;
    const vec3 apart = points_[middle] - p;
    const float distance = glm::dot(apart, apart), side = apart[axis];
    if (distance > least) best = std::min(best, distance);
    const bool lower = side > 0;
    const auto go = [&](bool to_lower) {
      search(to_lower ? first : middle + 1, to_lower ? middle : last, (axis + 1) % 3, p, least, best);
    };
    go(lower);
    if (side * side < best) go(!lower);
  }
  std::vector<vec3>& points_;
};

}  // namespace

float peak_distance(std::span<const vec3> position, std::span<const uint32_t> index) {
  if (position.empty() || index.empty()) return 0;
  const std::vector<uint32_t> first = weld(position);
  std::vector<uint32_t> edges;
  edges.reserve(index.size() * 2);
  Bounds box{position[index[0]], position[index[0]]};
  for (size_t t = 0; t + 2 < index.size(); t += 3)
    for (size_t k = 0; k < 3; ++k) {
      const uint32_t a = index[t + k], b = index[t + (k + 1) % 3];
      edges.push_back(first[a]), edges.push_back(first[b]);
      box.min = glm::min(box.min, position[a]), box.max = glm::max(box.max, position[a]);
    }
  const float same = tolerance * glm::length(box.max - box.min);
  double sum = 0;
  size_t count = 0;
  for (int direction = 0; direction < 6; ++direction) {
    std::vector<vec3> peaks = peaks_along(position, edges, direction / 2, direction % 2 ? -1.0f : 1.0f, same);
    const Nearest nearest(peaks);
    for (const vec3& peak : peaks) {
      const float squared = nearest.from(peak, same);
      if (!std::isfinite(squared)) continue;
      sum += std::sqrt(double(squared));
      ++count;
    }
  }
  return count ? float(sum / double(count)) : 0;
}

float peak_distance(const Scene& scene) {
  std::vector<vec3> position;
  std::vector<uint32_t> index;
  for (uint32_t i = 0; i < scene.instances.size(); ++i) {
    const Primitive& primitive = scene.primitives[scene.instances.primitive[i]];
    const uint32_t base = uint32_t(position.size());
    const std::vector<vec3> deformed = deform(scene, i, Moment::Now).position;
    position.insert(position.end(), deformed.begin(), deformed.end());
    for (uint32_t n = 0; n < primitive.index_count; ++n)
      index.push_back(base + scene.geometry.index[primitive.first_index + n]);
  }
  return peak_distance(position, index);
}

}  // namespace nf::scene
