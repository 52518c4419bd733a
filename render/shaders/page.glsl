#version 450 core
// Pictures are drawn in device pixels with y down; the first row of the framebuffer is the picture's top.
layout(location = 0) uniform vec2 page_size;
const vec2 corner[6] = vec2[](vec2(0, 0), vec2(1, 0), vec2(1, 1), vec2(0, 0), vec2(1, 1), vec2(0, 1));
vec4 on_page(vec2 p) { return vec4(p / page_size * 2.0 - 1.0, 0.0, 1.0); }
