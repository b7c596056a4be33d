#include "sky.glsl"
#include "pixel.glsl"

in vec3 ray;

#ifdef CLOUDS
uniform sampler2D clouds;
uniform vec2 drift;
#endif

void main() {
    vec3 direction = normalize(ray);
    vec3 shade = sky(direction);
#ifdef SUN
    shade += sun(direction);
#endif
#ifdef CLOUDS
    // A flat layer, seen from below: it closes up towards the horizon, where it fades out.
    float up = max(direction.z, 0.0);
    vec4 cloud = texture(clouds, direction.xy * (0.35 / (up + 0.10)) + drift);
    shade = mix(shade, cloud.rgb, cloud.a * min(up * 12.0, 1.0));
#endif
    put(shade);
}
