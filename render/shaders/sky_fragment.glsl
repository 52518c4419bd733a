in vec3 beyond;
out vec4 pixel;
void main() {
  vec3 direction = eye.w > 0.5 ? normalize(beyond - eye.xyz) : view_direction.xyz;
  pixel = vec4(developed(sky_color(direction)), 1.0);
}
