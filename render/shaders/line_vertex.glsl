// One instance a segment: a quad round the capsule of the segment.
layout(std430, binding = 0) readonly buffer Points { vec4 points[]; };  // x, y, arc length
layout(location = 1) uniform float half_width;
layout(location = 3) uniform int next;  // 1: segments of a line; 0: single dots
flat out vec4 segment;
flat out float start;
void main() {
  vec2 a = points[gl_InstanceID].xy, b = points[gl_InstanceID + next].xy, along = b - a;
  float size = length(along), reach = half_width + 1.0;
  along = size > 0.0 ? along / size : vec2(1, 0);
  vec2 across = vec2(-along.y, along.x), u = corner[gl_VertexID];
  segment = vec4(a, b);
  start = points[gl_InstanceID].z;
  gl_Position = on_page(mix(a - along * reach, b + along * reach, u.x) + across * reach * (2.0 * u.y - 1.0));
}
