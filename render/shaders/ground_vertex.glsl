const float reach = 320.0;
const vec2 corner[6] = vec2[](vec2(-1, -1), vec2(1, -1), vec2(1, 1), vec2(-1, -1), vec2(1, 1), vec2(-1, 1));
out vec3 world, normal;
void main() {
  world = vec3(eye.xy + reach * corner[gl_VertexID], 0.0);
  normal = vec3(0.0, 0.0, 1.0);
  gl_Position = view_projection * vec4(world, 1.0);
}
