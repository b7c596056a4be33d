// Solid surfaces: from the model's frame to the world and to clip space.
#include "solid_facet.glsl"

in vec3 position;
in vec3 normal;
in vec3 color;
in mat4 model;
#ifdef EDGES
in float mark;
#endif
uniform mat4 view_projection;
uniform Facet given;
flat out Facet facet;
out vec3 surface;
out vec3 surface_normal;

#ifdef UV
in vec2 uv;
out vec2 surface_uv;
#endif
#ifdef BUMPS
in vec4 tangent;  // w: sign of the bitangent
out vec3 surface_tangent;
out vec3 surface_bitangent;
#endif
#ifdef EMISSIVE
in vec3 emission;
#endif
#ifdef SPECULAR
in vec3 specular;
#endif

void main() {
    facet = given;
    facet.color = color;
#ifdef EDGES
    facet.mark = mark;
#endif
#ifdef EMISSIVE
    facet.emission = emission;
#endif
#ifdef SPECULAR
    facet.specular = specular;
#endif

    vec4 world = model * vec4(position, 1.0);
    surface = world.xyz;
    surface_normal = mat3(model) * normal;  // models are never scaled
#ifdef UV
    surface_uv = uv;
#endif
#ifdef BUMPS
    surface_tangent = mat3(model) * tangent.xyz;
    surface_bitangent = cross(surface_normal, surface_tangent) * tangent.w;
#endif
    gl_Position = view_projection * world;
}
