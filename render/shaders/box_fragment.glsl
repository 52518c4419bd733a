#version 450 core
layout(location = 2) uniform vec4 color;
out vec4 pixel;
void main() { pixel = color; }
