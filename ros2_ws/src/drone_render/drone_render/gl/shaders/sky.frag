// The sky: colors, stars, the sun and clouds.
#include "sky_facet.glsl"
flat in Facet facet;
#include "sky.glsl"
#include "pixel.glsl"

in vec3 ray;

#ifdef STARS
uniform sampler2D stars;
#endif
#ifdef CLOUDS
uniform sampler2D clouds;
#endif

void main() {
    vec3 sight = normalize(ray);
    // The intersection of the line of sight with a unit sphere around the domes' center.
    float b = dot(facet.offset, sight);
    vec3 direction = facet.offset + sight * (sqrt(max(b * b + 1.0 - dot(facet.offset, facet.offset), 0.0)) - b);
    vec3 shade = sky(direction);
    float up = max(direction.z, 0.0);
#ifdef STARS
    // Stereographic projection keeps stars round.
    shade += texture(stars, direction.xy * (1.6 / (1.0 + up))).rgb * (facet.starlight * min(up * 5.0, 1.0));
#endif
#ifdef SUN
    shade += sun(sight);
#endif
#ifdef CLOUDS
    // A flat layer seen from below: denser towards the horizon, where it fades out.
    vec4 cloud = texture(clouds, direction.xy * (0.35 / (up + 0.10)) + facet.drift);
    shade = mix(shade, cloud.rgb * facet.cloudlight, cloud.a * min(up * 12.0, 1.0));
#endif
    put(shade);
}
