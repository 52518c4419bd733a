// The picture in fields, each from its corners: the sky changes so little from one to the next that lines between them
// are as good as the sky itself, and cost a third.
const ivec2 fields = ivec2(32, 24);
const ivec2 corner[6] = ivec2[](ivec2(0, 0), ivec2(1, 0), ivec2(1, 1), ivec2(0, 0), ivec2(1, 1), ivec2(0, 1));
out vec3 color;
void main() {
  int field = gl_VertexID / 6;
  ivec2 at = ivec2(field % fields.x, field / fields.x) + corner[gl_VertexID % 6];
  vec2 clip = 2.0 * vec2(at) / vec2(fields) - 1.0;
  vec4 far_point = from_clip * vec4(clip, 1.0, 1.0);
  vec3 direction = eye.w > 0.5 ? normalize(far_point.xyz / far_point.w - eye.xyz) : view_direction.xyz;
  color = developed(sky_color(direction));
  gl_Position = vec4(clip, 1.0, 1.0);
}
