// Solid things, lit per pixel.
#include "lights.glsl"

in vec3 surface;
in vec3 surface_normal;
uniform vec3 colour;
uniform vec3 ambient;
out vec3 pixel;

#ifdef UV
in vec2 surface_uv;
#endif
#ifdef TEXTURED
uniform sampler2D colour_map;
#endif
#ifdef NORMAL_MAP
in vec3 surface_tangent;
in vec3 surface_bitangent;
uniform sampler2D normal_map;
#endif
#ifdef EMISSIVE
uniform vec3 emission;
#endif
#ifdef SPECULAR
uniform vec3 specular;
uniform vec3 eye;
#endif

void main() {
#ifdef NORMAL_MAP
    vec3 bump = texture(normal_map, surface_uv).xyz * 2.0 - 1.0;
    vec3 n = normalize(surface_tangent * bump.x + surface_bitangent * bump.y + surface_normal * bump.z);
#else
    vec3 n = normalize(surface_normal);
#endif

    vec3 diffuse = ambient * (0.75 + 0.25 * n.z);  // more of it comes from above
#ifdef SPECULAR
    vec3 gloss = vec3(0.0);
    vec3 mirrored = reflect(normalize(surface - eye), n);
#if LIGHTS > 0
    shine(surface, n, mirrored, diffuse, gloss);
#endif
#elif LIGHTS > 0
    shine(surface, n, diffuse);
#endif

#ifdef TEXTURED
    vec3 base = texture(colour_map, surface_uv).rgb * colour;
#else
    vec3 base = colour;
#endif
    pixel = base * diffuse;
#ifdef SPECULAR
    pixel += specular * gloss;
#endif
#ifdef EMISSIVE
#ifdef TEXTURED
    pixel += emission * base;
#else
    pixel += emission;
#endif
#endif
}
