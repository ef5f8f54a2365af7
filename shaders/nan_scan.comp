// Counts the texels of an image with a NaN or an infinity, and finds the first of them, into a row of a table. By their bits: what
// isnan() says is up to the device. BEGIN: empties the table.
#version 460
#include "params/nan_scan"

#ifdef BEGIN
layout(local_size_x = 64) in;
layout(scalar) writeonly buffer table { uint words[]; } found;

void main() {
  uint row = gl_GlobalInvocationID.x;
  if (row >= nan_scan.rows) return;
  found.words[3u * row] = found.words[3u * row + 1u] = 0u;
  found.words[3u * row + 2u] = 0xFFFFFFFFu;
}
#else
layout(local_size_x = 8, local_size_y = 8) in;
uniform texture2D source;
layout(scalar) buffer table { uint words[]; } found;

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy), size = textureSize(source, 0);
  if (any(greaterThanEqual(pixel, size))) return;
  uvec4 magnitude = floatBitsToUint(texelFetch(source, pixel, 0)) & 0x7FFFFFFFu;
  uint largest = max(max(magnitude.x, magnitude.y), max(magnitude.z, magnitude.w));
  if (largest < 0x7F800000u) return;
  uint at = 3u * nan_scan.row;
  atomicAdd(found.words[at + (largest > 0x7F800000u ? 0u : 1u)], 1u);
  atomicMin(found.words[at + 2u], uint(pixel.y * size.x + pixel.x));
}
#endif
