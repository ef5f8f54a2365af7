// The user interface's triangles, in pixels.
#version 460
#include "params/ui"

struct UiVertex {
  vec2 position, uv;
  uint color, draw;
};
layout(scalar) readonly buffer vertex_table { UiVertex rows[]; } vertices;

layout(location = 0) out vec2 uv;
layout(location = 1) out vec4 color;
layout(location = 2) flat out uint draw;

void main() {
  UiVertex v = vertices.rows[gl_VertexIndex];
  uv = v.uv;
  color = unpackUnorm4x8(v.color);
  draw = v.draw;
  gl_Position = vec4(v.position * ui.pixel_to_clip - 1.0, 0.0, 1.0);
}
