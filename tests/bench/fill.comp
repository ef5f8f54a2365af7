// Something to read for the yardstick.
#version 460
layout(local_size_x = 64, local_size_y = 1) in;
uniform writeonly image2D target;
void main() { imageStore(target, ivec2(gl_GlobalInvocationID.xy), vec4(float(gl_GlobalInvocationID.x + gl_GlobalInvocationID.y))); }
