layout(binding = 0) uniform sampler2DShadow shadow_map;

const vec3 horizon = vec3(1.08, 1.22, 1.38), zenith = vec3(0.34, 0.62, 1.02);

vec3 sky_color(vec3 direction) {
  float up = max(direction.z, 0.0);
  vec3 sky = mix(horizon, zenith, 1.0 - exp(-3.2 * up));
  float glow = pow(max(dot(direction, sun.xyz), 0.0), 24.0);
  return sky + 0.2 * glow * vec3(1.0, 0.92, 0.78);
}

vec3 towards_eye(vec3 p) { return eye.w > 0.5 ? normalize(eye.xyz - p) : -view_direction.xyz; }

// Share of the sun that arrives: one bilinear comparison where a pixel is larger than the texels of the map, else 2 x 2,
// which together weigh 3 x 3 texels as a tent. The point is moved along its normal by about the texel's size, which the
// slope-scaled offset of the map completes: neither acne nor a gap under the links.
float sunlight(vec3 p, vec3 normal) {
  vec3 c = (light_projection * vec4(p + normal * 1.2 * sun.w, 1.0)).xyz * 0.5 + 0.5;
  if (any(lessThan(c, vec3(0.002))) || any(greaterThan(c, vec3(0.998)))) return 1.0;
#ifdef LARGE_PIXELS
  return texture(shadow_map, c);
#else
  vec2 half_texel = 0.5 / vec2(textureSize(shadow_map, 0));
  float sum = 0.0;
  for (int i = -1; i <= 1; i += 2)
    for (int j = -1; j <= 1; j += 2) sum += texture(shadow_map, vec3(c.xy + half_texel * vec2(i, j), c.z));
  return 0.25 * sum;
#endif
}

// 1 under the middle of the vehicle, 0 well outside of it.
float under_vehicle(vec2 p, float softness) {
  vec2 d = p - footprint.xy;
  vec2 local = abs(vec2(footprint.z * d.x + footprint.w * d.y, -footprint.w * d.x + footprint.z * d.y));
  vec2 inside = smoothstep(vec2(softness), vec2(-softness), local - footprint_size.xy);
  return inside.x * inside.y;
}

vec3 shade(vec3 albedo, float gloss, vec3 p, vec3 n, float sky_share) {
  vec3 v = towards_eye(p);
  float facing = dot(n, sun.xyz);
  float light = facing > 0.0 ? sunlight(p, n) * facing : 0.0;
  vec3 ambient = mix(vec3(0.27, 0.245, 0.21), vec3(0.44, 0.51, 0.62), 0.5 + 0.5 * n.z) * sky_share;
  vec3 h = normalize(v + sun.xyz);
  float aside = clamp(1.0 - dot(n, v), 0.0, 1.0), aside2 = aside * aside, grazing = aside2 * aside2 * aside;
  float highlight = gloss * (0.35 + 0.65 * grazing) * pow(max(dot(n, h), 0.0), mix(8.0, 90.0, gloss)) * light;
  vec3 mirrored = 0.35 * gloss * grazing * sky_share * mix(vec3(0.3), horizon, 0.5 + 0.5 * reflect(-v, n).z);
  return albedo * (ambient + light * vec3(2.55, 2.38, 2.10)) + 1.3 * highlight * vec3(1.0, 0.95, 0.85) + mirrored;
}

// Share of the horizon's light in what is seen of p.
float haze(vec3 p) {
  vec3 d = p - eye.xyz;
  return eye.w * (1.0 - exp(-dot(d, d) / 8100.0));
}

// Soft shoulder: bright paint keeps its hue, nothing clips. The result is sRGB (IEC 61966-2-1), encoded here once a
// pixel, for an sRGB framebuffer would do it once a sample: by roots, within half a step of 255 of the exact curve
// (3 steps in the darkest hundredth).
vec3 encoded(vec3 c) {
  vec3 a = sqrt(c), b = sqrt(a), d = sqrt(b);
  return max(0.585122381 * a + 0.783140355 * b - 0.368262736 * d, 0.0);
}
vec3 developed(vec3 c) { return encoded(1.0 - exp(-0.95 * c)); }
