// What reaches a point of a surface: `diffuse`, and `gloss` where it mirrors.
vec3 diffuse;
#ifdef SPECULAR
vec3 mirrored;
vec3 gloss = vec3(0.0);
#endif

// 1 / sqrt(x) within 0.07 %, which nobody sees: a root and a division take as long as all else of a light. After Moroz
// et al. (2018), Fast calculation of inverse square root with the use of magic constant.
float rsqrt(float x) {
    float y = intBitsToFloat(0x5F1FFFF9 - (floatBitsToInt(x) >> 1));
    return y * (1.68191391 - 0.703952253 * x * y * y);
}

// Adds a light of which `share` arrives. `way` leads to it, and is 1 / `scale` long.
void shine(vec3 light, vec3 way, float scale, float share, vec3 n) {
    diffuse += light * (share * (scale * max(dot(n, way), 0.0)));
#ifdef SPECULAR
    // Squared SPECULAR times: pow() costs more than all the rest of a light here.
    float s = scale * max(dot(mirrored, way), 0.0);
    for (int k = 0; k < SPECULAR; ++k) s *= s;
    gloss += light * (share * s);
#endif
}

// Point lights. The number is a constant, so that the loop unrolls: a program for each number that occurs.
#if LIGHTS > 0
void shine_all(vec3 surface, vec3 n) {
    for (int i = 0; i < LIGHTS; ++i) {
        vec4 place = facet.lights[NUMBERS * i];
        vec4 light = facet.lights[NUMBERS * i + 1];
        vec3 way = place.xyz - surface;
        float square = dot(way, way);
        float weak = 1.0 + square * place.w;
        float both = rsqrt(square * (weak * weak));  // 1 / (distance * weak), which yields each of them
        float scale = both * weak;
        float share = max(1.0 - square * light.w, 0.0) * (both * square * scale);
#ifdef BEAMS
        vec4 beam = facet.lights[NUMBERS * i + 2];
        share *= clamp(scale * dot(way, beam.xyz) + beam.w, 0.0, 1.0);
#endif
        shine(light.rgb, way, scale, share, n);
    }
}
#endif
