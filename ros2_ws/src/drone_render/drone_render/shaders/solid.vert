// Solid things: to the world, and on to the screen.
in vec3 position;
in vec3 normal;
uniform mat4 model;
uniform mat4 view_projection;
out vec3 surface;
out vec3 surface_normal;

#ifdef UV
in vec2 uv;
out vec2 surface_uv;
#endif
#ifdef NORMAL_MAP
in vec4 tangent;  // w: which way the bitangent points
out vec3 surface_tangent;
out vec3 surface_bitangent;
#endif

void main() {
    vec4 world = model * vec4(position, 1.0);
    surface = world.xyz;
    surface_normal = mat3(model) * normal;  // models are turned and moved, never stretched
#ifdef UV
    surface_uv = uv;
#endif
#ifdef NORMAL_MAP
    surface_tangent = mat3(model) * tangent.xyz;
    surface_bitangent = cross(surface_normal, surface_tangent) * tangent.w;
#endif
    gl_Position = view_projection * world;
}
