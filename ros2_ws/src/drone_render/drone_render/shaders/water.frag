// Water: four trains of waves tilt the normal, and the sky is mirrored by Fresnel's share.
#include "pixel.glsl"
#ifdef SKY
#include "sky.glsl"
uniform vec3 horizon;
#endif

in vec3 surface;
uniform vec3 eye;
uniform vec3 deep;
uniform vec3 shallow;
uniform vec3 ambient;
uniform vec4 wave_x;      // wave numbers of the trains, rad/m
uniform vec4 wave_y;
uniform vec4 wave_phase;  // rad
uniform vec4 slope_x;     // steepest slope of each train
uniform vec4 slope_y;
uniform vec4 wave_pixel;  // radians of a wave within the angle of a pixel, at a distance of 1 m
#ifdef SHORE
uniform vec3 square;      // of the survey: its middle and half its side
uniform sampler2D shore;  // how clear the water is
#endif

void main() {
    vec3 sight = surface - eye;
    float nearness = inversesqrt(dot(sight, sight));
    vec3 v = -sight * nearness;

    // The long trains push the short ones about, so that no pattern repeats.
    vec4 phase = wave_x * surface.x + wave_y * surface.y + wave_phase;
    phase.zw += 1.4 * sin(phase.xy);
    // A train fades as its waves, foreshortened, shrink to a few pixels: or the far water flickers.
    vec4 crowded = wave_pixel / (nearness * max(v.z, 0.01));
    vec4 rise = cos(phase) / (1.0 + crowded * crowded);
    vec3 n = normalize(vec3(-dot(rise, slope_x), -dot(rise, slope_y), 1.0));

    float facing = max(dot(n, v), 0.0);
    float away = 1.0 - facing;
    float away2 = away * away;
    float fresnel = 0.02 + 0.78 * away2 * away2 * away;  // not 1: far waves hide each other's flat sides
    vec3 mirrored = reflect(-v, n);
    mirrored.z = abs(mirrored.z);

    vec3 light = ambient;
#ifdef SUN
    light += sun_colour * max(dot(n, sun_direction), 0.0);
#endif
#ifdef SHORE
    float clear = texture(shore, (surface.xy - square.xy) / square.z * 0.5 + 0.5).r;
#else
    float clear = 0.0;
#endif
    float lift = 0.08 * (rise.x + rise.z);
    vec3 body = mix(deep, shallow, clamp(1.6 * clear + 0.25 * facing + lift, 0.0, 1.0)) * light;
    vec3 shade;
#ifdef SKY
    shade = mix(body, sky(mirrored), fresnel);
    float near = 450.0 * nearness;
    shade = mix(shade, horizon, 1.0 / (1.0 + near * near));  // haze, so that sea and sky meet
#else
    shade = mix(body, ambient, fresnel);
#endif
#ifdef SHORE
    // Foam where the waves run out, its edge moved by them; it hides neither light nor colour below all of it.
    float foam = clamp((clear + 0.10 * (rise.y + rise.z) - 0.86) * 9.0, 0.0, 1.0);
    shade = mix(shade, light, 0.75 * foam);
#endif
#ifdef SUN
    float s = max(dot(mirrored, sun_direction), 0.0);
    s *= s; s *= s; s *= s; s *= s;
    float wide = s;
    s *= s; s *= s; s *= s;
    shade += sun_colour * (0.12 * wide + 0.9 * s);
#endif
    put(shade);
}
