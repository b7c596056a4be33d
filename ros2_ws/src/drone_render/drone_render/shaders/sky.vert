// One triangle that covers the screen, as far away as can be.
#include "sky_facet.glsl"

uniform mat3 rays;  // columns: the camera's ahead, right and down, the latter two as long as half the picture
uniform Facet given;
flat out Facet facet;
out vec3 ray;

void main() {
    facet = given;
    vec2 corner = vec2(gl_VertexID == 2 ? 3.0 : -1.0, gl_VertexID == 1 ? 3.0 : -1.0);  // clockwise is the front
    ray = rays * vec3(1.0, corner);
    gl_Position = vec4(corner, 1.0, 1.0);
}
