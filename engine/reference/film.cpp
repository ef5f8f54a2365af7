// The table of layers, and how a sample falls into them.
#include "reference/film.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>

#include "core/error.h"

namespace nf::reference {
namespace {

constexpr LayerInfo infos[] = {
    {"", "RGB", "final radiance: direct + ambient + indirect + emissive, the environment behind"},
    {"direct", "RGB", "sun, point and spot lights, diffuse and specular"},
    {"direct_diffuse", "RGB", "the diffuse part of it"},
    {"direct_specular", "RGB", "the specular part of it"},
    {"indirect", "RGB", "diffuse reflectance * gi"},
    {"gi", "RGB", "light straight from emissive surfaces and light that bounced: irradiance / pi"},
    {"ambient", "RGB", "light straight from the environment, as reflected"},
    {"specular", "RGB", "light over a specular bounce, in no other layer, and not in the final radiance"},
    {"visibility", "V", "cosine-weighted share of open directions"},
    {"bent", "XYZ", "mean open direction, world space, unit"},
    {"albedo", "RGB", "base colour"},
    {"normal", "XYZ", "shading normal, world space, unit"},
    {"depth", "V", "metres along the view axis, 0 = background"},
    {"position", "XYZ", "world space, metres"},
    {"emissive", "RGB", "emission towards the eye"},
    {"radiance", "RGB", "what the screen-space GI gathers from: direct_diffuse + emissive"},
};
constexpr size_t info_count = std::size(infos);

const LayerInfo* find_info(std::string_view name) {
  for (const LayerInfo& info : infos)
    if (name == info.name) return &info;
  return nullptr;
}

bool is(const Slot& slot, std::string_view base) {
  return slot.info->name == base;
}

// "gi_3" is `gi` with three bounces.
Slot make_slot(const std::string& name, uint32_t bounces) {
  Slot slot{find_info(name), name, bounces, 0, 0};
  const size_t bar = name.rfind('_');
  if (!slot.info && bar != std::string::npos) {
    const LayerInfo* base = find_info(std::string_view(name).substr(0, bar));
    uint32_t count = 0;
    const char* end = name.data() + name.size();
    const auto [stop, error] = std::from_chars(name.data() + bar + 1, end, count);
    const bool counted = base && (std::string_view(base->name) == "gi" || std::string_view(base->name) == "indirect");
    if (counted && error == std::errc() && stop == end && count >= 1) {
      if (count > bounces)
        fail(Exit::Input, "no layer '{}': the paths have only {} bounces; raise --bounces", name, bounces);
      slot.info = base;
      slot.bounces = count;
    }
  }
  if (!slot.info) {
    std::string known;
    for (const LayerInfo& info : infos)
      if (*info.name) known += fmt::format(" {}", info.name);
    fail(Exit::Input, "no layer '{}'; there are{}, and gi_K, indirect_K with K bounces", name, known);
  }
  slot.channels = uint32_t(std::string_view(slot.info->channels).size());
  return slot;
}

vec3 gi_of(const PixelSample& sample, uint32_t bounces) {
  vec3 sum(0);
  for (uint32_t k = 0; k < bounces; ++k) sum += sample.gi[k];
  return sum;
}

vec3 final_radiance(const PixelSample& p, uint32_t bounces) {
  const Surface& s = p.surface;
  vec3 sum = p.hit ? p.direct_diffuse + p.direct_specular + p.ambient + s.emission + s.diffuse * gi_of(p, bounces)
                   : p.background;
  sum *= p.weight;
  for (const PixelSample& before : p.blended) sum += final_radiance(before, bounces);
  return sum;
}

vec3 value_of(const Slot& slot, const PixelSample& p) {
  const Surface& s = p.surface;
  switch (size_t(slot.info - infos)) {
    case 0:
      return final_radiance(p, slot.bounces);
    case 1:
      return p.direct_diffuse + p.direct_specular;
    case 2:
      return p.direct_diffuse;
    case 3:
      return p.direct_specular;
    case 4:
      return s.diffuse * gi_of(p, slot.bounces);
    case 5:
      return gi_of(p, slot.bounces);
    case 6:
      return p.ambient;
    case 7:
      return p.specular;
    case 8:
      return vec3(p.visibility);
    case 9:
      return p.bent;
    case 10:
      return s.albedo;
    case 11:
      return s.n;
    case 12:
      return vec3(p.depth);
    case 13:
      return s.position;
    case 14:
      return s.emission;
    default:
      return p.direct_diffuse + s.emission;
  }
}
static_assert(info_count == 16, "value_of knows the rows by number");

}  // namespace

std::span<const LayerInfo> layer_infos() {
  return infos;
}

std::vector<std::string> parse_layers(const std::string& list, uint32_t bounces) {
  std::vector<std::string> names = {""};
  const auto add = [&](const std::string& name) {
    make_slot(name, bounces);
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  };
  if (list == "all") {
    for (const LayerInfo& info : infos) add(info.name);
    for (uint32_t k = 1; k < bounces; ++k) add(fmt::format("gi_{}", k)), add(fmt::format("indirect_{}", k));
    return names;
  }
  for (size_t at = 0; at < list.size();) {
    const size_t comma = std::min(list.find(',', at), list.size());
    add(list.substr(at, comma - at));
    at = comma + 1;
  }
  return names;
}

Film make_film(const std::vector<std::string>& layers, glm::uvec2 size, uint32_t bounces) {
  Film film;
  film.size = size;
  for (const std::string& name : layers) {
    Slot slot = make_slot(name, bounces);
    slot.offset = film.channels;
    film.channels += slot.channels;
    film.slots.push_back(slot);
  }
  film.sums.resize(size_t(size.x) * size.y * 2 * film.channels);
  return film;
}

Wanted wanted_by(const Film& film) {
  Wanted wanted;
  for (const Slot& slot : film.slots) {
    const bool final_radiance = is(slot, "");
    wanted.direct |= final_radiance || std::string_view(slot.info->name).starts_with("direct") || is(slot, "radiance");
    wanted.gi |= final_radiance || is(slot, "gi") || is(slot, "indirect");
    wanted.ambient |= final_radiance || is(slot, "ambient");
    wanted.visibility |= is(slot, "visibility") || is(slot, "bent");
    wanted.specular |= is(slot, "specular");
  }
  return wanted;
}

void add_sample(const Film& film, const PixelSample& sample, double* sums) {
  for (const Slot& slot : film.slots) {
    const vec3 value = value_of(slot, sample);
    for (uint32_t c = 0; c < slot.channels; ++c) sums[slot.offset + c] += double(value[int(c)]);
  }
}

std::vector<image::Layer> resolve(const Film& film, int half) {
  std::vector<image::Layer> layers;
  const size_t pixels = size_t(film.size.x) * film.size.y;
  const double scale = film.samples ? 1.0 / (double(film.samples) * (half < 0 ? 2 : 1)) : 0;
  for (const Slot& slot : film.slots) {
    image::Layer layer{slot.name, slot.info->channels, {film.size.x, film.size.y, slot.channels, {}}};
    layer.image.pixels.reserve(pixels * slot.channels);
    const bool unit = is(slot, "bent") || is(slot, "normal");
    for (size_t i = 0; i < pixels; ++i) {
      glm::dvec3 value(0);
      for (uint32_t c = 0; c < slot.channels; ++c) {
        if (half != 1) value[int(c)] += film.at(i, 0)[slot.offset + c];
        if (half != 0) value[int(c)] += film.at(i, 1)[slot.offset + c];
      }
      value *= scale;
      const double length = glm::length(value);
      if (unit && length > 0) value /= length;
      for (uint32_t c = 0; c < slot.channels; ++c) layer.image.pixels.push_back(float(value[int(c)]));
    }
    layers.push_back(std::move(layer));
  }
  return layers;
}

std::vector<Noise> noise_of(const Film& film) {
  std::vector<Noise> rows;
  const size_t pixels = size_t(film.size.x) * film.size.y;
  if (film.samples == 0 || pixels == 0) return rows;
  for (const Slot& slot : film.slots) {
    double squares = 0, sum = 0;
    for (size_t i = 0; i < pixels; ++i) {
      const double *a = film.at(i, 0) + slot.offset, *b = film.at(i, 1) + slot.offset;
      for (uint32_t c = 0; c < slot.channels; ++c) {
        squares += (a[c] - b[c]) * (a[c] - b[c]);
        sum += std::abs(a[c] + b[c]);
      }
    }
    if (squares == 0) continue;
    // The halves are independent: the mean's variance is a quarter of their difference's.
    const double count = double(pixels) * slot.channels, n = double(film.samples);
    rows.push_back({slot.name, std::sqrt(squares / count) / (2 * n), sum / (2 * n * count)});
  }
  return rows;
}

}  // namespace nf::reference
