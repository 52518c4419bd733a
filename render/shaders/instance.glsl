struct Instance {
  mat4 X_WB;
  vec4 tint;
  vec4 look;  // x: share of light of its own
};
layout(std430, binding = 1) readonly buffer Instances { Instance instances[]; };
layout(location = 0) uniform int first_instance;
layout(location = 0) in vec3 position;
