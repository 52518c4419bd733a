in vec3 world, world_normal;
flat in vec4 surface;
flat in float glow, hazed;
layout(location = 1) uniform float opacity;
out vec4 pixel;
void main() {
  vec3 n = normalize(world_normal), color = surface.rgb;
  if (glow < 1.0) {
    float sky_share = 1.0 - 0.62 * under_vehicle(world.xy, 0.25) * (1.0 - smoothstep(0.1, 1.3, world.z));
    color = developed(mix(shade(color, surface.a, world, n, sky_share), horizon, hazed));
  }
  // Enough shading that the form is seen, little enough that the colour is that of the legend.
  if (glow > 0.0) color = mix(color, encoded(surface.rgb * (0.86 + 0.14 * dot(n, sun.xyz))), glow);
  pixel = vec4(color, opacity);
}
