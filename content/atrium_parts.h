// The parts the atrium is put together from. Each adds shapes to the builder's current object, at its origin: x along
// the wall, y up, the wall's front to +z.
#pragma once

#include "builder.h"

namespace nf::content {

struct AtriumMaterials {
  MaterialId ashlar, plaster, floor, roof, wood, iron, pot, soil, leaf, water, flame;
  MaterialId cloth[3];  // red, green, blue
};
AtriumMaterials atrium_materials(Builder& b);

// Foot, shaft with a swelling, capital and square plates; `height` in all, `radius` of the shaft.
void add_column(Builder& b, const AtriumMaterials& m, float height, float radius);

// A wall `width` wide from `spring` to `top` with a round arch of `radius` cut out of its lower edge, and mouldings
// around it on both sides; a blind one, before a wall, has only its front.
struct Arch {
  float width, radius, spring, top, thickness;
};
void add_arch(Builder& b, const AtriumMaterials& m, const Arch& arch, bool blind = false);

// The ceiling of a bay of width x depth: two round vaults that cross, their corners at y = spring, `rise` high.
void add_vault(Builder& b, const AtriumMaterials& m, float width, float depth, float spring, float rise);

// Balusters between two rails, 1 m high, `width` wide.
void add_railing(Builder& b, const AtriumMaterials& m, float width);

// A wooden door of two wings in a stone frame, on a wall at z = 0; as shutters where it stands higher.
void add_door(Builder& b, const AtriumMaterials& m, float width, float height);

// A cloth that hangs in folds from (+-width/2, 0) down by `drop`, drawn together towards `gather` (-1 left, 1 right).
void add_curtain(Builder& b, MaterialId cloth, float width, float drop, float gather);

// A cloth across the court: from `top`, width/2 to both sides in z, down by `drop`. In world space, for a skin.
void add_banner(Builder& b, MaterialId cloth, vec3 top, float width, float drop);

// A terracotta pot with a plant of `leaves` broad leaves; `seed` makes them differ.
void add_plant(Builder& b, const AtriumMaterials& m, uint32_t leaves, uint32_t seed);

// Hangs from the origin on a chain of `length`.
void add_lantern(Builder& b, const AtriumMaterials& m, float length);

// A stone basin with water and a bowl on a foot in its middle.
void add_fountain(Builder& b, const AtriumMaterials& m);

// A moulded band of stone from `from` to `to`, sticking out to the right of that direction.
void add_cornice(Builder& b, MaterialId stone, vec3 from, vec3 to, float depth, float height);

}  // namespace nf::content
