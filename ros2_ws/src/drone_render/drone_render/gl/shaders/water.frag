// Water: four wave trains tilt the normal, and the sky is reflected by the Fresnel term.
#include "water_facet.glsl"
flat in Facet facet;
#ifdef SHORE
out vec4 pixel;  // alpha: the share of the ground below that the water hides
#else
#include "pixel.glsl"
#endif
#ifdef SKY
#include "sky.glsl"
#endif

in vec3 surface;
#ifdef SHORE
uniform sampler2D shore;  // clearness of the water, 0 to 1
#endif

void main() {
    vec3 sight = surface - facet.eye;
    float nearness = inversesqrt(dot(sight, sight));
    vec3 v = -sight * nearness;

    // The long wave trains advect the short ones, so that no pattern repeats.
    vec4 phase = facet.wave_x * surface.x + facet.wave_y * surface.y + facet.wave_phase;
    phase.zw += 1.4 * sin(phase.xy);
    // A wave train fades as its foreshortened waves shrink to a few pixels; else distant water would flicker.
    vec4 phase_per_pixel = facet.wave_pixel / (nearness * max(v.z, 0.01));
    vec4 rise = cos(phase) / (1.0 + phase_per_pixel * phase_per_pixel);
    vec3 n = normalize(vec3(-dot(rise, facet.slope_x), -dot(rise, facet.slope_y), 1.0));

    float facing = max(dot(n, v), 0.0);
    float away = 1.0 - facing;
    float away2 = away * away;
    float fresnel = 0.02 + 0.78 * away2 * away2 * away;  // less than 1 at grazing angles, as waves hide each other's flat sides
    vec3 mirrored = reflect(-v, n);
    mirrored.z = abs(mirrored.z);

    vec3 light = facet.ambient;
#ifdef SUN
    light += facet.sun_color * max(dot(n, facet.sun_direction), 0.0);
#endif
#ifdef SHORE
    float clear = texture(shore, (surface.xy - facet.square.xy) / facet.square.z * 0.5 + 0.5).r;
    // The flatter the line of sight, the longer its path under water, and the less of the ground is visible.
    float seen = clear * mix(clear * clear * clear, 1.0, v.z);
#else
    const float clear = 0.0, seen = 0.0;
#endif
    float lift = 0.08 * (rise.x + rise.z);
    vec3 body = mix(facet.deep, facet.shallow, clamp(1.6 * clear + 0.25 * facing + lift, 0.0, 1.0)) * light;
    vec3 shade;
#ifdef SKY
    shade = mix(body * (1.0 - seen), sky(mirrored), fresnel);
    float near = 450.0 * nearness;
    shade = mix(shade, facet.horizon, 1.0 / (1.0 + near * near));  // haze blends the sea into the sky
#else
    shade = mix(body * (1.0 - seen), facet.ambient, fresnel);
#endif
#ifdef SHORE
    // Foam at the shore, its edge moved by the waves. It thins out towards the land and never hides all.
    float foam = clamp((clear + 0.10 * (rise.y + rise.z) - 0.80) * 5.0, 0.0, 0.8) * clamp(9.0 - 9.0 * clear, 0.0, 1.0);
    shade = mix(shade, light, foam);
    seen *= (1.0 - fresnel) * (1.0 - foam);
#endif
#ifdef SUN
    float s = max(dot(mirrored, facet.sun_direction), 0.0);
    s *= s; s *= s; s *= s; s *= s;
    float wide = s;
    s *= s; s *= s; s *= s;
    shade += facet.sun_color * (0.12 * wide + 0.9 * s);
#endif
#ifdef SHORE
    pixel = vec4(shade, 1.0 - seen);
#else
    put(shade);
#endif
}
