#version 450 core
in vec3 color;
out vec4 pixel;
void main() { pixel = vec4(color, 1.0); }
