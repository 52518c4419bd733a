#version 450 core
// Shared by every program of a scene; layout of struct FrameBlock in scene_renderer.cpp.
layout(std140, binding = 0) uniform Frame {
  mat4 view_projection, from_clip, light_projection;
  vec4 eye;             // World [m]; w: 1 for a perspective
  vec4 view_direction;  // of a parallel camera
  vec4 sun;             // towards it; w: size of a shadow texel in World [m]
  vec4 footprint;       // centre x, y; cosine and sine of its heading
  vec4 footprint_size;  // half length, half width [m]
};
