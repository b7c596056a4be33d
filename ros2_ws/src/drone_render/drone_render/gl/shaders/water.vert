// Water surfaces: from the model's frame to the world and to clip space.
#include "water_facet.glsl"

in vec3 position;
in mat4 model;
uniform mat4 view_projection;
uniform Facet given;
flat out Facet facet;
out vec3 surface;

void main() {
    facet = given;
    vec4 world = model * vec4(position, 1.0);
    surface = world.xyz;
    gl_Position = view_projection * world;
}
