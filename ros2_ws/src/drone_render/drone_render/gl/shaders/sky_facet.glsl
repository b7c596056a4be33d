// Constants of the sky; see solid_facet.glsl.
struct Facet {
    vec3 offset;  // from the domes' center to the eye, in radii
#ifdef STARS
    float starlight;
#endif
#ifdef CLOUDS
    vec3 cloudlight;
    vec2 drift;
#endif
#ifdef SUN
    vec3 sun_direction;
    vec3 sun_color;
#endif
#ifdef EDGES
    float mark;
#endif
};
