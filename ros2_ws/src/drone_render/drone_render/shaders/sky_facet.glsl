// What all pixels of the sky have in common; see solid_facet.glsl.
struct Facet {
    vec3 inside;  // of the domes: from their middle to the eye, in radii
#ifdef STARS
    float starlight;
#endif
#ifdef CLOUDS
    vec3 cloudlight;
    vec2 drift;
#endif
#ifdef SUN
    vec3 sun_direction;
    vec3 sun_colour;
#endif
#ifdef EDGES
    float mark;
#endif
};
