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
uniform vec4 lights[2 * LIGHTS];
// Two of each: its place and 1 / reach^2, 0 where distance does not weaken;
// its colour and what is taken off its share, so that the light ends somewhere.

void shine_all(vec3 surface, vec3 n) {
    for (int i = 0; i < LIGHTS; ++i) {
        vec4 place = lights[2 * i];
        vec4 colour = lights[2 * i + 1];
        vec3 way = place.xyz - surface;
        float square = dot(way, way);
        shine(n, way * inversesqrt(square), colour.rgb, max(1.0 / (1.0 + square * place.w) - colour.w, 0.0));
    }
}
#endif
