in vec3 world, normal;
out vec4 pixel;

float hash(ivec2 i) {
  uint h = uint(i.x) * 0x9E3779B1u ^ uint(i.y) * 0x85EBCA77u;
  h = (h ^ (h >> 15)) * 0x2C1B3C6Du;
  return float((h ^ (h >> 13)) & 0xFFFFu) / 65535.0;
}

float noise(vec2 u) {
  ivec2 i = ivec2(floor(u));
  vec2 f = u - vec2(i), s = f * f * (3.0 - 2.0 * f);
  return mix(mix(hash(i), hash(i + ivec2(1, 0)), s.x), mix(hash(i + ivec2(0, 1)), hash(i + ivec2(1, 1)), s.x), s.y) -
         0.5;
}

// Share of a pixel that lines of `width` (of the spacing 1) cover, filtered over the pixel so that it never shimmers.
float lines(vec2 u, float width) {
  vec2 pixel_size = fwidth(u);
  vec2 drawn = clamp(vec2(width), pixel_size, vec2(0.5));
  vec2 distance_to_line = abs(fract(u + 0.5) - 0.5);
  vec2 cover = smoothstep(0.5 * drawn + 0.75 * pixel_size, 0.5 * drawn - 0.75 * pixel_size, distance_to_line);
  cover *= clamp(width / drawn, 0.0, 1.0);
  cover = mix(cover, vec2(width), clamp(2.0 * pixel_size - 1.0, 0.0, 1.0));
  return cover.x + cover.y - cover.x * cover.y;
}

void main() {
  vec2 p = world.xy;
  float grain = max(fwidth(p.x), fwidth(p.y));  // metres a pixel
  vec3 albedo = vec3(0.34, 0.305, 0.25);
  albedo *= 1.0 + 0.16 * noise(p * 0.23) * clamp(2.0 - grain, 0.0, 1.0);
  if (grain < 0.25) albedo *= 1.0 + 0.22 * noise(p * 2.3) * clamp(1.5 - 6.0 * grain, 0.0, 1.0);
  if (grain < 0.03) albedo *= 1.0 + 0.20 * noise(p * 17.0) * clamp(1.5 - 50.0 * grain, 0.0, 1.0);
  albedo = mix(albedo, vec3(0.17, 0.155, 0.13), 0.55 * lines(p, 0.022));
  albedo = mix(albedo, vec3(0.72, 0.68, 0.60), 0.60 * lines(p * 0.1, 0.006));
  float sky_share = 1.0 - 0.70 * under_vehicle(p, 0.45);
  vec3 color = shade(albedo, 0.02, world, normalize(normal), sky_share);
  pixel = vec4(developed(mix(color, horizon, haze(world))), 1.0);
}
