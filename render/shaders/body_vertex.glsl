layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 color;
layout(location = 3) in float gloss;
out vec3 world, world_normal;
flat out vec4 surface;
flat out float glow, hazed;
void main() {
  Instance i = instances[first_instance + gl_InstanceID];
  vec4 p = i.X_WB * vec4(position, 1.0);
  world = p.xyz;
  world_normal = mat3(i.X_WB) * normal;
  surface = vec4(mix(color, i.tint.rgb, i.tint.a), gloss);
  glow = i.look.x;
  hazed = haze(i.X_WB[3].xyz);
  gl_Position = view_projection * p;
}
