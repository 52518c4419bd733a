void main() { gl_Position = light_projection * instances[first_instance + gl_InstanceID].X_WB * vec4(position, 1.0); }
