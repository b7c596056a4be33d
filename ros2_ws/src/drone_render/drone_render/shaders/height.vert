// The land from above: x and y to the square that is surveyed, what is higher hides what is lower.
in vec3 position;
uniform mat4 model;
uniform vec3 square;  // its middle, and half of its side
uniform float level;  // of the water, m
out float height;

void main() {
    vec4 world = model * vec4(position, 1.0);
    height = world.z;
    gl_Position = vec4((world.xy - square.xy) / square.z, (level - world.z) * 0.001, 1.0);
}
