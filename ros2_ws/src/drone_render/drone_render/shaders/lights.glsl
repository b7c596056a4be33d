// What reaches a point of a surface: `diffuse`, and `gloss` where it mirrors.
vec3 diffuse;
#ifdef SPECULAR
vec3 mirrored;
vec3 gloss = vec3(0.0);
#endif

// Adds `share` of a light's colour that comes from l.
void shine(vec3 n, vec3 l, vec3 colour, float share) {
    diffuse += colour * (share * max(dot(n, l), 0.0));
#ifdef SPECULAR
    // Squared SPECULAR times: pow() costs more than all the rest of a light here.
    float s = max(dot(mirrored, l), 0.0);
    for (int k = 0; k < SPECULAR; ++k) s *= s;
    gloss += colour * (share * s);
#endif
}

// The sun is so far away that its direction is the same everywhere, and needs neither a root nor a division.
#ifdef SUN
uniform vec3 sun_direction;
uniform vec3 sun_colour;
#endif

// Point lights. The number is a constant, so that the loop unrolls: a program for each number that occurs.
#if LIGHTS > 0
#ifdef BEAMS
#define NUMBERS 3
#else
#define NUMBERS 2
#endif
uniform vec4 lights[NUMBERS * LIGHTS];
// Of each: its place and 1 / reach^2, 0 where distance does not weaken; its colour and what is taken off its share, so
// that the light ends somewhere; its beam, by which the cosine to its axis becomes a share.

void shine_all(vec3 surface, vec3 n) {
    for (int i = 0; i < LIGHTS; ++i) {
        vec4 place = lights[NUMBERS * i];
        vec4 colour = lights[NUMBERS * i + 1];
        vec3 way = place.xyz - surface;
        float square = dot(way, way);
        vec3 l = way * inversesqrt(square);
        float share = max(1.0 / (1.0 + square * place.w) - colour.w, 0.0);
#ifdef BEAMS
        vec4 beam = lights[NUMBERS * i + 2];
        share *= clamp(dot(l, beam.xyz) + beam.w, 0.0, 1.0);
#endif
        shine(n, l, colour.rgb, share);
    }
}
#endif
