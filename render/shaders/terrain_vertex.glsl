layout(location = 0) in vec3 position;
layout(location = 1) in vec3 up;
out vec3 world, normal;
void main() {
  world = position;
  normal = up;
  gl_Position = view_projection * vec4(world, 1.0);
}
