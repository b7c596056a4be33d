// The sky without its clouds: what water mirrors, too.
uniform vec3 horizon;
uniform vec3 zenith;

vec3 sky(vec3 direction) {
    float up = max(direction.z, 0.0);
    float low = 1.0 - up;
    low *= low;
    low *= low;
    return mix(zenith, horizon, low * low);  // the haze ends low: most cameras see little more than the horizon
}

#ifdef SUN
uniform vec3 sun_direction;
uniform vec3 sun_colour;

// Squared again and again: a wide glow, and a narrow one around the disk.
vec3 sun(vec3 direction) {
    float s = max(dot(direction, sun_direction), 0.0);
    s *= s; s *= s; s *= s;
    float glow = s;
    s *= s; s *= s; s *= s; s *= s; s *= s;
    float narrow = s;
    s *= s; s *= s; s *= s;
    return sun_colour * (0.16 * glow + 0.35 * narrow + min(s * 3.0, 1.0));
}
#endif
