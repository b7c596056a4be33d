// Solid things, lit per pixel.
#include "lights.glsl"
#include "pixel.glsl"

in vec3 surface;
in vec3 surface_normal;
flat in vec3 surface_colour;
uniform vec3 ambient;

#ifdef UV
in vec2 surface_uv;
#endif
#ifdef BUMPS
in vec3 surface_tangent;
in vec3 surface_bitangent;
#endif
#ifdef COLOUR_NORMAL_MAP
uniform sampler2D colour_normal_map;
uniform vec3 ramp[3];
#endif
#ifdef COLOUR_MAP
uniform sampler2D colour_map;
#endif
#ifdef NORMAL_MAP
uniform sampler2D normal_map;
#endif
#ifdef EMISSIVE
flat in vec3 surface_emission;
#endif
#ifdef SPECULAR
flat in vec3 surface_specular;
uniform vec3 eye;
#endif

void main() {
    vec3 base = surface_colour;
#ifdef COLOUR_NORMAL_MAP
    vec4 both = texture(colour_normal_map, surface_uv);
    base *= ramp[0] + ramp[1] * both.r + ramp[2] * both.g;
    vec2 tilt = both.ba * 2.0 - 1.0;
    vec3 bump = vec3(tilt, sqrt(max(1.0 - dot(tilt, tilt), 0.0)));
#endif
#ifdef COLOUR_MAP
    base *= texture(colour_map, surface_uv).rgb;
#endif
#ifdef NORMAL_MAP
    vec3 bump = texture(normal_map, surface_uv).xyz * 2.0 - 1.0;
#endif
#ifdef BUMPS
    vec3 n = normalize(surface_tangent * bump.x + surface_bitangent * bump.y + surface_normal * bump.z);
#else
    vec3 n = normalize(surface_normal);
#endif

    diffuse = ambient * (0.75 + 0.25 * n.z);  // more of it comes from above
#ifdef SPECULAR
    mirrored = reflect(normalize(surface - eye), n);
#endif
#ifdef SUN
    shine(n, sun_direction, sun_colour, 1.0);
#endif
#if LIGHTS > 0
    shine_all(surface, n);
#endif

    vec3 shade = base * diffuse;
#ifdef SPECULAR
    shade += surface_specular * gloss;
#endif
#ifdef EMISSIVE
#ifdef COLOUR_MAP
    shade += surface_emission * base;
#else
    shade += surface_emission;
#endif
#endif
    put(shade);
}
