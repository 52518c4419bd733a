layout(location = 1) uniform vec4 box;
void main() { gl_Position = on_page(mix(box.xy, box.zw, corner[gl_VertexID])); }
