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
    // Where the sight meets a sphere of radius 1 around the domes' middle.
    float b = dot(facet.inside, sight);
    vec3 direction = facet.inside + sight * (sqrt(max(b * b + 1.0 - dot(facet.inside, facet.inside), 0.0)) - b);
    vec3 shade = sky(direction);
    float up = max(direction.z, 0.0);
#ifdef STARS
    // Stereographic: stars stay round.
    shade += texture(stars, direction.xy * (1.6 / (1.0 + up))).rgb * (facet.starlight * min(up * 5.0, 1.0));
#endif
#ifdef SUN
    shade += sun(sight);
#endif
#ifdef CLOUDS
    // A flat layer, seen from below: it closes up towards the horizon, where it fades out.
    vec4 cloud = texture(clouds, direction.xy * (0.35 / (up + 0.10)) + facet.drift);
    shade = mix(shade, cloud.rgb * facet.cloudlight, cloud.a * min(up * 12.0, 1.0));
#endif
    put(shade);
}
