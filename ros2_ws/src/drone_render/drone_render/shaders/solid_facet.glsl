// What all pixels of a facet have in common. Its vertices hand it on: a software rasteriser fetches every number of a
// uniform anew for each few pixels, one by one and checked, which took half of their time; flat ones it has at hand.
#ifdef BEAMS
#define NUMBERS 3
#else
#define NUMBERS 2
#endif

struct Facet {
    vec3 colour;
    vec3 ambient;
#ifdef COLOUR_NORMAL_MAP
    vec3 ramp[3];     // from the map's numbers to colours
    float steepness;  // of the map, at most
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
    vec3 sun_colour;
#endif
#if LIGHTS > 0
    // Of each: its place and 1 / reach^2, 0 where distance does not weaken; its colour and 1 / d^2 where it ends; its
    // beam, by which the cosine to its axis becomes a share.
    vec4 lights[NUMBERS * LIGHTS];
#endif
#ifdef EDGES
    float mark;
#endif
};
