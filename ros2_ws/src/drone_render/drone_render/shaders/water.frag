// Water: four trains of waves tilt the normal, and the sky is mirrored by Fresnel's share.
#ifdef SKY
#include "sky.glsl"
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
out vec3 pixel;

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
    float square = away * away;
    float fresnel = 0.02 + 0.98 * square * square * away;
    vec3 mirrored = reflect(-v, n);
    mirrored.z = abs(mirrored.z);

    vec3 light = ambient;
#ifdef SUN
    light += sun_colour * max(dot(n, sun_direction), 0.0);
#endif
    vec3 body = mix(deep, shallow, clamp(0.6 * facing * facing + 0.25 * (rise.x + rise.z), 0.0, 1.0)) * light;
#ifdef SKY
    pixel = mix(body, sky(mirrored), fresnel);
#else
    pixel = mix(body, ambient, fresnel);
#endif
#ifdef SUN
    float s = max(dot(mirrored, sun_direction), 0.0);
    s *= s; s *= s; s *= s; s *= s;
    float wide = s;
    s *= s; s *= s; s *= s;
    pixel += sun_colour * (0.12 * wide + 0.9 * s);
#endif
}
