// The sky without clouds and stars; water reflects this part of it.
uniform sampler2D colors;  // from the horizon to the zenith

vec3 sky(vec3 direction) {
    return texture(colors, vec2(sqrt(max(direction.z, 0.0)), 0.5)).rgb;
}

#ifdef SUN
// Powers of the cosine by repeated squaring: a wide glow, a narrow one, and the disk.
vec3 sun(vec3 direction) {
    float s = max(dot(direction, facet.sun_direction), 0.0);
    s *= s; s *= s; s *= s;
    float glow = s;
    s *= s; s *= s; s *= s; s *= s; s *= s;
    float narrow = s;
    s *= s; s *= s; s *= s;
    return facet.sun_color * (0.16 * glow + 0.35 * narrow + min(s * 3.0, 1.0));
}
#endif
