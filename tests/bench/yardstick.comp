// The yardstick for GI passes: every pixel reads 32 texels of an R32F image along a random direction within 64 pixels and
// sums them. What a technique costs is quoted in multiples of this.
#version 460

layout(local_size_x = 64, local_size_y = 1) in;
uniform texture2D source;
uniform writeonly image2D target;

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy), size = textureSize(source, 0);
  if (pixel.x >= size.x || pixel.y >= size.y) return;
  uint bits = (uint(pixel.x) * 747796405u + uint(pixel.y) * 2891336453u) * 277803737u;
  float angle = float(bits >> 8) * (6.2831853 / 16777216.0);
  vec2 direction = vec2(cos(angle), sin(angle)) * 2.0;
  float sum = 0.0;
  for (int i = 1; i <= 32; ++i) sum += texelFetch(source, clamp(pixel + ivec2(direction * float(i)), ivec2(0), size - 1), 0).x;
  imageStore(target, pixel, vec4(sum));
}
