// Solid surfaces, lit per pixel.
#include "solid_facet.glsl"
flat in Facet facet;
#include "lights.glsl"
#include "pixel.glsl"

in vec3 surface;
in vec3 surface_normal;

#ifdef UV
in vec2 surface_uv;
#endif
#ifdef BUMPS
in vec3 surface_tangent;
in vec3 surface_bitangent;
#endif
#ifdef COLOR_NORMAL_MAP
uniform sampler2D color_normal_map;
#endif
#ifdef COLOR_MAP
uniform sampler2D color_map;
#endif
#ifdef NORMAL_MAP
uniform sampler2D normal_map;
#endif

void main() {
    vec3 base = facet.color;
#ifdef COLOR_NORMAL_MAP
    vec4 both = texture(color_normal_map, surface_uv);
    base *= facet.ramp[0] + facet.ramp[1] * both.r + facet.ramp[2] * both.g;
    vec3 bump = vec3((both.ba * 2.0 - 1.0) * facet.steepness, 1.0);
#endif
#ifdef COLOR_MAP
    base *= texture(color_map, surface_uv).rgb;
#endif
#ifdef NORMAL_MAP
    vec3 bump = texture(normal_map, surface_uv).xyz * 2.0 - 1.0;
#endif
#ifdef BUMPS
    vec3 n = surface_tangent * bump.x + surface_bitangent * bump.y + surface_normal * bump.z;
#else
    vec3 n = surface_normal;
#endif
    n *= rsqrt(dot(n, n));

    diffuse = facet.ambient * (0.75 + 0.25 * n.z);  // ambient light is brighter from above
#ifdef SPECULAR
    vec3 sight = surface - facet.eye;
    mirrored = reflect(sight * rsqrt(dot(sight, sight)), n);
#endif
#ifdef SUN
    shine(facet.sun_color, facet.sun_direction, 1.0, 1.0, n);
#endif
#if LIGHTS > 0
    shine_all(surface, n);
#endif

    vec3 shade = base * diffuse;
#ifdef SPECULAR
    shade += facet.specular * gloss;
#endif
#ifdef EMISSIVE
#ifdef UV
    shade += facet.emission * base;
#else
    shade += facet.emission;
#endif
#endif
    put(shade);
}
