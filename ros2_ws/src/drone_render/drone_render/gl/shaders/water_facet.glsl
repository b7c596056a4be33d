// Constants of the water; see solid_facet.glsl.
struct Facet {
    vec3 eye;
    vec3 deep;
    vec3 shallow;
    vec3 ambient;
    vec4 wave_x;      // wave vectors of the four trains, rad/m
    vec4 wave_y;
    vec4 wave_phase;  // rad
    vec4 slope_x;     // steepest slope of each train, times its heading
    vec4 slope_y;
    vec4 wave_pixel;  // phase of each train within the angle of a pixel, at a distance of 1 m, rad
#ifdef SKY
    vec3 horizon;
#endif
#ifdef SUN
    vec3 sun_direction;
    vec3 sun_color;
#endif
#ifdef SHORE
    vec3 square;      // of the shore map: x and y of its center, and half its side, m
#endif
#ifdef EDGES
    float mark;
#endif
};
