#version 450 core
flat in vec4 left, right;
out float coverage;
void main() {
  float t = clamp((gl_FragCoord.x - left.x) / max(right.x - left.x, 1e-6), 0.0, 1.0);
  vec2 edges = mix(left.yz, right.yz, t);
  coverage = clamp(gl_FragCoord.y - edges.x + 0.5, 0.0, 1.0) * clamp(edges.y - gl_FragCoord.y + 0.5, 0.0, 1.0);
}
