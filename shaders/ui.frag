// The user interface: text and plain areas, and the pictures that are in their places already.
#version 460

uniform texture2D font, pictures;
uniform sampler linear_clamp;

layout(location = 0) in vec2 uv;
layout(location = 1) in vec4 color;
layout(location = 2) flat in uint draw;  // 0: text
layout(location = 0) out vec4 picture;   // premultiplied

void main() {
  float alpha = color.a * (draw == 0u ? textureLod(sampler2D(font, linear_clamp), uv, 0.0).r : 1.0);
  vec3 rgb = draw == 0u ? color.rgb : color.rgb * texelFetch(pictures, ivec2(gl_FragCoord.xy), 0).rgb;
  picture = vec4(rgb * alpha, alpha);
}
