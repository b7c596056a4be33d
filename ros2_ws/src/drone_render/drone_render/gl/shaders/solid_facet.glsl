// Facet: the constants of a triangle, passed from the uniform `given` to the fragment shader as flat varyings. A software
// rasterizer fetches uniforms again for every few pixels, with a bounds check each, which took half of the pixels' time;
// flat varyings stay in registers.
#ifdef BEAMS
#define NUMBERS 3
#else
#define NUMBERS 2
#endif

struct Facet {
    vec3 color;
    vec3 ambient;
#ifdef COLOR_NORMAL_MAP
    vec3 ramp[3];     // decodes the map's first two channels into a color
    float steepness;  // steepest slope in the map
#endif
#ifdef EMISSIVE
    vec3 emission;
#endif
#ifdef SPECULAR
    vec3 specular;
    vec3 eye;
#endif
#ifdef SUN
    vec3 sun_direction;
    vec3 sun_color;
#endif
#if LIGHTS > 0
    // Per light: position and 1 / reach^2 (0 without falloff); color and 1 / d^2 of the distance d where it ends; and for
    // beams the scaled axis and offset that map the cosine to the axis to a share from 0 to 1.
    vec4 lights[NUMBERS * LIGHTS];
#endif
#ifdef EDGES
    float mark;
#endif
};
