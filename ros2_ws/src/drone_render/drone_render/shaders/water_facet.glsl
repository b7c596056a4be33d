// What all pixels of the water have in common; see solid_facet.glsl.
struct Facet {
    vec3 eye;
    vec3 deep;
    vec3 shallow;
    vec3 ambient;
    vec4 wave_x;      // wave numbers of the trains, rad/m
    vec4 wave_y;
    vec4 wave_phase;  // rad
    vec4 slope_x;     // steepest slope of each train
    vec4 slope_y;
    vec4 wave_pixel;  // radians of a wave within the angle of a pixel, at a distance of 1 m
#ifdef SKY
    vec3 horizon;
#endif
#ifdef SUN
    vec3 sun_direction;
    vec3 sun_colour;
#endif
#ifdef SHORE
    vec3 square;      // of the survey: its middle and half its side
#endif
#ifdef EDGES
    float mark;
#endif
};
