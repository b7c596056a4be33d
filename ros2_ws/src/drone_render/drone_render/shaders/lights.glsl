// Point lights. The number is a constant, so that the loop unrolls: a program for each number that occurs.
#if LIGHTS > 0
uniform vec4 light_position[LIGHTS];  // w: 1 / reach^2, 0 where distance does not weaken
uniform vec4 light_colour[LIGHTS];    // w: what is taken off, so that the light ends somewhere

#ifdef SPECULAR
void shine(vec3 surface, vec3 n, vec3 mirrored, inout vec3 diffuse, inout vec3 gloss) {
#else
void shine(vec3 surface, vec3 n, inout vec3 diffuse) {
#endif
    for (int i = 0; i < LIGHTS; ++i) {
        vec3 way = light_position[i].xyz - surface;
        float square = dot(way, way);
        vec3 l = way * inversesqrt(square);
        float left = max(1.0 / (1.0 + square * light_position[i].w) - light_colour[i].w, 0.0);
        vec3 arriving = light_colour[i].rgb * left;
        diffuse += arriving * max(dot(n, l), 0.0);
#ifdef SPECULAR
        // Squared SPECULAR times: pow() costs more than all the rest of a light here.
        float s = max(dot(mirrored, l), 0.0);
        for (int k = 0; k < SPECULAR; ++k) s *= s;
        gloss += arriving * s;
#endif
    }
}
#endif
