in vec3 world, world_normal;
flat in vec4 surface;
out vec4 pixel;
void main() {
  float sky_share = 1.0 - 0.62 * under_vehicle(world.xy, 0.25) * (1.0 - smoothstep(0.1, 1.3, world.z));
  vec3 color = shade(surface.rgb, surface.a, world, normalize(world_normal), sky_share);
  pixel = vec4(developed(with_haze(color, world)), 1.0);
}
