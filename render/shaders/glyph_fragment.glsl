#version 450 core
layout(binding = 0) uniform sampler2D atlas;
layout(location = 2) uniform vec4 color;
in vec2 texel;
out vec4 pixel;
void main() { pixel = vec4(color.rgb, color.a * texelFetch(atlas, ivec2(texel), 0).r); }
