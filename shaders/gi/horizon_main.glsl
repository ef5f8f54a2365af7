// A horizon pass over the pixels; `horizon` is the technique's own block.
#include "gi/inputs.glsl"

uniform writeonly image2D visibility;
#if HORIZON_BENT
uniform writeonly image2D bent;
#endif
#if HORIZON_MULTI_BOUNCE
uniform texture2D albedo;
#endif

#include "gi/horizon.glsl"

void main() {
  ivec2 pixel = dispatch_pixel();
  if (pixel.x >= frame.size.x || pixel.y >= frame.size.y) return;
  INSPECT_BEGIN(pixel);
  Openness open = estimate_horizons(pixel);
  INSPECT_END(0, open.visibility, vec3(0.0f));
#if HORIZON_MULTI_BOUNCE
  open.visibility = multi_bounce(open.visibility, dot(texelFetch(albedo, pixel, 0).rgb, vec3(0.2126f, 0.7152f, 0.0722f)));
#endif
  imageStore(visibility, pixel, vec4(open.visibility));
#if HORIZON_BENT
  imageStore(bent, pixel, vec4(open.bent, 0.0f));
#endif
}
