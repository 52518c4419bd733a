in vec3 world, normal;
out vec4 pixel;
// Ground cut open: hatched as in a drawing, paler with depth; normal.z is the depth [m].
void main() {
  float depth = normal.z, along = dot(world, normalize(cross(view_direction.xyz, vec3(0.0, 0.0, 1.0))));
  float u = (along + world.z) * 9.0, width = fwidth(u);
  float line = 1.0 - smoothstep(0.0, 1.5 * width, abs(fract(u + 0.5) - 0.5) - 0.04);
  vec3 color = mix(vec3(0.40, 0.35, 0.28), vec3(0.55, 0.52, 0.47), smoothstep(0.0, 0.9, depth));
  color *= 1.0 - 0.16 * line * (1.0 - smoothstep(0.2, 0.8, depth));
  color *= mix(0.45, 1.0, smoothstep(0.008, 0.022, depth));
  pixel = vec4(encoded(color), 1.0);
}
