layout(location = 1) uniform vec4 box;
layout(location = 3) uniform vec4 cell;  // of the atlas, texels
layout(location = 4) uniform int upwards;  // 1: the text runs up the page
out vec2 texel;
void main() {
  vec2 u = corner[gl_VertexID];
  texel = mix(cell.xy, cell.zw, upwards == 1 ? vec2(1.0 - u.y, u.x) : u);
  gl_Position = on_page(mix(box.xy, box.zw, u));
}
