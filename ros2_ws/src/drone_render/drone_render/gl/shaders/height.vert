// Orthographic view of the land from above; the depth test keeps the highest point of each pixel.
in vec3 position;
uniform mat4 model;
uniform vec3 square;  // x and y of the map's center, and half of its side, m
uniform float level;  // of the water, m
out float height;

void main() {
    vec4 world = model * vec4(position, 1.0);
    height = world.z;
    gl_Position = vec4((world.xy - square.xy) / square.z, (level - world.z) * 0.001, 1.0);
}
