// The visibility-bitmask pass over the pixels; BITMASK_LIGHT as in gi/bitmask.glsl. `bitmask` is the technique's own block.
#include "gi/inputs.glsl"

uniform writeonly image2D visibility;
#if BITMASK_LIGHT
FETCH_UINT_IMAGE(radiance);  // what surfaces send out
uniform writeonly image2D light;
#define FETCH_RADIANCE(texel) FETCH(radiance, texel)
#endif
#if BITMASK_AMBIENT
uniform writeonly image2D bent;
uniform writeonly image2D ambient;
#define AMBIENT_SOURCE BITMASK_AMBIENT_SOURCE
// A lobe about as wide as a region.
#define AMBIENT_ROUGHNESS (bitmask.regions > 6 ? 0.4f : bitmask.regions > 2 ? 0.6f : 0.9f)
#include "gi/environment_from.glsl"
#endif

#include "gi/bitmask.glsl"

void main() {
  ivec2 pixel = dispatch_pixel();
  if (pixel.x >= frame.size.x || pixel.y >= frame.size.y) return;
  INSPECT_BEGIN(pixel);
  Gathered gathered = estimate_bitmask(pixel);
  INSPECT_END(SECTOR_COUNT, gathered.visibility, gathered.gi);
  imageStore(visibility, pixel, vec4(gathered.visibility));
#if BITMASK_LIGHT
  imageStore(light, pixel, vec4(gathered.gi, 1.0f));
#endif
#if BITMASK_AMBIENT
  imageStore(bent, pixel, vec4(gathered.bent, 0.0f));
  imageStore(ambient, pixel, vec4(gathered.ambient, 1.0f));
#endif
}
