// The sky without its clouds: what water mirrors, too.
uniform sampler2D colours;  // from the horizon to the zenith

vec3 sky(vec3 direction) {
    return texture(colours, vec2(sqrt(max(direction.z, 0.0)), 0.5)).rgb;
}

#ifdef SUN
// Squared again and again: a wide glow, and a narrow one around the disk.
vec3 sun(vec3 direction) {
    float s = max(dot(direction, facet.sun_direction), 0.0);
    s *= s; s *= s; s *= s;
    float glow = s;
    s *= s; s *= s; s *= s; s *= s; s *= s;
    float narrow = s;
    s *= s; s *= s; s *= s;
    return facet.sun_colour * (0.16 * glow + 0.35 * narrow + min(s * 3.0, 1.0));
}
#endif
