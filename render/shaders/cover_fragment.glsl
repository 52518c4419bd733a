#version 450 core
layout(binding = 0) uniform sampler2D coverage;
layout(location = 2) uniform vec4 color;
out vec4 pixel;
void main() { pixel = vec4(color.rgb, color.a * texelFetch(coverage, ivec2(gl_FragCoord.xy), 0).r); }
