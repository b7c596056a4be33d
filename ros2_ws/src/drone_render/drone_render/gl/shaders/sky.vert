// One triangle that covers the picture, at the far plane.
#include "sky_facet.glsl"

uniform mat3 rays;  // columns: the camera's forward axis, and half the picture's width and height as vectors
uniform Facet given;
flat out Facet facet;
out vec3 ray;

void main() {
    facet = given;
    vec2 corner = vec2(gl_VertexID == 2 ? 3.0 : -1.0, gl_VertexID == 1 ? 3.0 : -1.0);  // clockwise is the front
    ray = rays * vec3(1.0, corner);
    gl_Position = vec4(corner, 1.0, 1.0);
}
