// Drawing of the shadow maps. What rests is kept from frame to frame and drawn anew only where a map shows something
// else than before; what moves is drawn over a copy of that. A map's texel is the nearest depth of all that was drawn,
// whatever the order, so that it has the very bytes of a map drawn whole.
#include <algorithm>
#include <cstring>

#include "shadow.h"

namespace nf::passes {

ShadowPass create_shadow(gpu::Pipelines& pipelines, const SceneTables& scene) {
  const auto streams = SceneTables::streams();
  gpu::RasterState opaque{.streams = {streams[0]}, .depth_test = true, .depth_write = true};
  gpu::RasterState masked{.streams = {streams.begin(), streams.end()},
                          .depth_test = true,
                          .depth_write = true,
                          .set1 = scene.material_set_layout()};
  return {pipelines.raster("shadow.vert", "", {}, opaque),
          pipelines.raster("shadow.vert", "shadow.frag", {{"MASKED", "1"}}, masked),
          pipelines.raster("shadow.vert", "shadow.frag", {{"MASKED", "1"}, {"MAPPED", "1"}}, masked)};
}

namespace {

struct PassNames {
  const char *opaque, *masked, *mapped;
};
// The maps of the sun, or of the spot and point lights.
struct GroupNames {
  const char *maps, *kept, *copy;
  PassNames resting, moving;
};
constexpr GroupNames sun_names{"shadow.sun",
                               "shadow.sun_kept",
                               "shadow.sun_copy",
                               {"shadow.sun_opaque", "shadow.sun_masked", "shadow.sun_mapped"},
                               {"shadow.sun_moving", "shadow.sun_moving_masked", "shadow.sun_moving_mapped"}};
constexpr GroupNames tile_names{"shadow.tiles",
                                "shadow.tiles_kept",
                                "shadow.tiles_copy",
                                {"shadow.tile_opaque", "shadow.tile_masked", "shadow.tile_mapped"},
                                {"shadow.tile_moving", "shadow.tile_moving_masked", "shadow.tile_moving_mapped"}};

// What all maps of a frame draw.
struct MapDraws {
  const SceneTables& scene;
  const ShadowPlan& plan;
  Sides sides;
  graph::Buf deformed;
  uint32_t revision;  // of the shaders
};

// One map: where it looks from, and what is in it.
struct Map {
  glm::mat4 clip_from_world;
  glm::vec3 eye;
  std::vector<uint32_t> resting, moving;  // instances
  uint64_t mark = 0;                      // of all that the resting ones' depths depend on; never 0
  bool stale = true;
};

class Mixer {
 public:
  void mix(uint64_t value) {
    hash_ = (hash_ ^ value) * 0x9E3779B97F4A7C15ull;
    hash_ ^= hash_ >> 29;
  }
  uint64_t result() const { return hash_ ? hash_ : 1; }

 private:
  uint64_t hash_ = 1469598103934665603ull;
};

// Blended surfaces drop other texels in every frame, and so count as moving.
bool moves(const MapDraws& what, uint32_t instance) {
  const scene::Scene& scene = what.scene.scene();
  const scene::Material& material = scene.materials[scene.primitives[scene.instances.primitive[instance]].material];
  const bool thins = what.plan.blending == Blending::Over && material.alpha == scene::AlphaMode::Blend;
  return thins || !what.scene.rests(instance);
}

void fill(Map& map, const MapDraws& what) {
  const scene::Scene& scene = what.scene.scene();
  std::vector<uint32_t> casters;
  scene::cull(scene::frustum_from_clip(map.clip_from_world), scene.instances.center, scene.instances.extent, casters);
  Mixer mark;
  uint64_t words[8];
  static_assert(sizeof words == sizeof map.clip_from_world);
  std::memcpy(words, &map.clip_from_world, sizeof words);
  for (const uint64_t word : words) mark.mix(word);
  mark.mix(uint64_t(what.revision) << 32 | uint64_t(what.sides) << 8 | uint64_t(what.plan.blending));
  for (const uint32_t i : casters) {
    if (moves(what, i)) {
      map.moving.push_back(i);
    } else {
      map.resting.push_back(i);
      mark.mix(uint64_t(i) << 32 | what.scene.changed_at(i));
    }
  }
  map.mark = mark.result();
}

enum class Begin : uint8_t { Cleared, ClearedByDraw, AsItIs };

// Draws nothing, but takes part in the frame, where `list` is nullptr: a plan then fits whatever maps are stale.
void add_draws(graph::Graph& graph, const ShadowPass& pass, const PassNames& names, graph::TexPart to, Begin begin,
               const glm::mat4& clip_from_world, const MapDraws& what, const DrawList* list) {
  const ShadowViewBlock view{clip_from_world, what.plan.blending == Blending::Over};
  const graph::Buf instances = graph.import("scene.instances", what.scene.instances());
  const SceneTables* tables = &what.scene;
  const Sides sides = what.sides;
  graph::PassBuilder opaque = graph.raster(names.opaque, pass.opaque, "Depth of opaque surfaces from the light");
  opaque.in("instances", instances).in("deformed", what.deformed);
  begin == Begin::Cleared ? opaque.depth(to, 0.0f) : opaque.depth(to);
  opaque.params(view).draw([=](const graph::Recorder& r) {
    if (list && begin == Begin::ClearedByDraw) r.clear_depth(0);
    if (list) tables->draw(*list, DrawClass::Opaque, false, r, sides);
  });
  const auto add_behind = [&](const char* name, gpu::Pipeline pipeline, DrawClass draw_class) {
    graph.raster(name, pipeline, "Depth of cut-out surfaces from the light")
        .in("instances", instances)
        .in("materials", graph.import("scene.materials", what.scene.materials()))
        .in("deformed", what.deformed)
        .depth(to)
        .params(view)
        .draw([=](const graph::Recorder& r) {
          if (list) tables->draw(*list, draw_class, true, r, sides);
        });
  };
  if (what.plan.masked) add_behind(names.masked, pass.masked, DrawClass::Masked);
  if (what.plan.mapped) add_behind(names.mapped, pass.mapped, DrawClass::Mapped);
}

// `draws` has two lists a map: what rests, or all, and what moves.
graph::Tex add_group(graph::Graph& graph, const ShadowPass& pass, const GroupNames& names, uint32_t side, bool cache,
                     std::span<Map> maps, const MapDraws& what, DrawList* draws) {
  const graph::ImageDesc desc{{side, side}, VK_FORMAT_D32_SFLOAT, 1, uint8_t(maps.size())};
  for (Map& map : maps) fill(map, what);
  const auto list = [&](size_t i, const std::vector<uint32_t>& instances, bool moving) {
    DrawList& drawn = draws[2 * i + moving];
    what.scene.build_draws(drawn, instances, maps[i].eye, Blending::CutOut);
    return &drawn;
  };
  if (!cache) {
    const graph::Tex image = graph.image(names.maps, desc);
    for (uint8_t i = 0; i < desc.layers; ++i) {
      std::vector<uint32_t> all = maps[i].resting;
      all.insert(all.end(), maps[i].moving.begin(), maps[i].moving.end());
      add_draws(graph, pass, names.resting, layer(image, i), Begin::Cleared, maps[i].clip_from_world, what,
                list(i, all, false));
    }
    return image;
  }
  const graph::Tex kept = graph.keep(names.kept, desc);
  bool stale = false, moving = false;
  for (uint8_t i = 0; i < desc.layers; ++i) {
    maps[i].stale = graph.mark(kept, i) != maps[i].mark;
    graph.mark(kept, i) = maps[i].mark;
    stale |= maps[i].stale;
    moving |= !maps[i].moving.empty();
  }
  for (uint8_t i = 0; stale && i < desc.layers; ++i)
    add_draws(graph, pass, names.resting, layer(kept, i), Begin::ClearedByDraw, maps[i].clip_from_world, what,
              maps[i].stale ? list(i, maps[i].resting, false) : nullptr);
  if (!moving) return kept;
  const graph::Tex image = graph.image(names.maps, desc);
  graph.copy(names.copy, kept, image);
  for (uint8_t i = 0; i < desc.layers; ++i)
    add_draws(graph, pass, names.moving, layer(image, i), Begin::AsItIs, maps[i].clip_from_world, what,
              maps[i].moving.empty() ? nullptr : list(i, maps[i].moving, true));
  return image;
}

}  // namespace

ShadowMaps add_shadows(graph::Graph& graph, const ShadowPass& pass, const ShadowParams& params, const ShadowPlan& plan,
                       const SceneTables& scene, std::vector<DrawList>& draws, graph::Buf deformed) {
  const MapDraws what{
      scene, plan, params.two_sided ? Sides::Both : Sides::AsMaterial, deformed,
      pass.opaque.interface->revision + pass.masked.interface->revision + pass.mapped.interface->revision};
  std::vector<Map> cascades, tiles;
  for (uint32_t i = 0; i < plan.sun.cascade_count; ++i) {
    const glm::vec3 c = cascade_of(plan.sun, i);
    cascades.push_back({.clip_from_world = clip_from_cascade(plan.sun, i),
                        .eye = plan.sun.right * c.x + plan.sun.down * c.y +
                               plan.sun.direction * ((1 - plan.sun.depth_offset) / plan.sun.depth_scale),
                        .resting = {},
                        .moving = {}});
  }
  for (const ShadowTile& tile : plan.tiles)
    tiles.push_back({.clip_from_world = clip_from_tile(tile), .eye = tile.position, .resting = {}, .moving = {}});
  draws.resize(std::max(draws.size(), 2 * (cascades.size() + tiles.size())));
  ShadowMaps maps;
  if (!cascades.empty())
    maps.sun =
        add_group(graph, pass, sun_names, uint32_t(params.resolution), params.cache, cascades, what, draws.data());
  if (!tiles.empty())
    maps.tiles = add_group(graph, pass, tile_names, uint32_t(params.tile_resolution), params.cache, tiles, what,
                           draws.data() + 2 * cascades.size());
  return maps;
}

}  // namespace nf::passes
