// One instance a strip between two abscissae: from the lower to the upper edge, and a pixel more.
layout(std430, binding = 0) readonly buffer Points { vec4 points[]; };  // x, upper y, lower y
flat out vec4 left, right;
void main() {
  left = points[gl_InstanceID];
  right = points[gl_InstanceID + 1];
  vec2 u = corner[gl_VertexID];
  float top = min(left.y, right.y) - 1.0, bottom = max(left.z, right.z) + 1.0;
  gl_Position = on_page(vec2(mix(left.x, right.x, u.x), mix(top, bottom, u.y)));
}
