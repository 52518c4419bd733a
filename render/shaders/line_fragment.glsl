#version 450 core
// Coverage of the pixel by a capsule. Drawn with GL_MAX: the union of the segments, so joints never blend twice.
flat in vec4 segment;
flat in float start;
layout(location = 1) uniform float half_width;
layout(location = 2) uniform vec2 dash;  // length drawn, period; period 0: solid
out float coverage;
void main() {
  vec2 p = gl_FragCoord.xy - segment.xy, along = segment.zw - segment.xy;
  float size2 = max(dot(along, along), 1e-12), t = clamp(dot(p, along) / size2, 0.0, 1.0);
  float c = clamp(half_width + 0.5 - length(p - along * t), 0.0, 1.0) * min(1.0, 2.0 * half_width);
  if (dash.y > 0.0) {
    float u = mod(start + dot(p, along) / sqrt(size2), dash.y);
    c *= clamp(min(u, dash.x - u) + 0.5, 0.0, 1.0);
  }
  coverage = c;
}
