// Sums the light at a point of a surface: `diffuse`, and `gloss` in highlights.
vec3 diffuse;
#ifdef SPECULAR
vec3 mirrored;  // unit vector from the surface along the reflected line of sight
vec3 gloss = vec3(0.0);
#endif

// 1 / sqrt(x) with an error below 0.07 %, which is invisible: a root and a division would cost as much as the rest of a
// light. After Moroz et al. (2018), Fast calculation of inverse square root with the use of magic constant.
float rsqrt(float x) {
    float y = intBitsToFloat(0x5F1FFFF9 - (floatBitsToInt(x) >> 1));
    return y * (1.68191391 - 0.703952253 * x * y * y);
}

// Adds a light whose color is `light`, weakened to `share`. `to_light` has the length 1 / `scale`; n: unit normal.
void shine(vec3 light, vec3 to_light, float scale, float share, vec3 n) {
    diffuse += light * (share * (scale * max(dot(n, to_light), 0.0)));
#ifdef SPECULAR
    // Squared SPECULAR times: pow() would cost more than the rest of a light.
    float s = scale * max(dot(mirrored, to_light), 0.0);
    for (int k = 0; k < SPECULAR; ++k) s *= s;
    gloss += light * (share * s);
#endif
}

// Adds the point lights. Their number is a constant, so that the loop is unrolled: one program for each number.
#if LIGHTS > 0
void shine_all(vec3 surface, vec3 n) {
    for (int i = 0; i < LIGHTS; ++i) {
        vec4 place = facet.lights[NUMBERS * i];
        vec4 light = facet.lights[NUMBERS * i + 1];
        vec3 to_light = place.xyz - surface;
        float square = dot(to_light, to_light);
        float falloff = 1.0 + square * place.w;
        float both = rsqrt(square * (falloff * falloff));  // 1 / (distance * falloff); each follows from it
        float scale = both * falloff;
        float share = max(1.0 - square * light.w, 0.0) * (both * square * scale);
#ifdef BEAMS
        vec4 beam = facet.lights[NUMBERS * i + 2];
        share *= clamp(scale * dot(to_light, beam.xyz) + beam.w, 0.0, 1.0);
#endif
        shine(light.rgb, to_light, scale, share, n);
    }
}
#endif
