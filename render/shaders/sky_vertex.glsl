out vec3 beyond;
void main() {
  vec2 clip = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0;
  vec4 far_point = from_clip * vec4(clip, 1.0, 1.0);
  beyond = far_point.xyz / far_point.w;
  gl_Position = vec4(clip, 1.0, 1.0);
}
