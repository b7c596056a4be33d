// Shapes for depth and labels.
in vec3 position;
in mat4 model;
in float mark;  // the object's label, from 1
uniform mat4 view_projection;
flat out float label;

void main() {
    label = mark;
    gl_Position = view_projection * (model * vec4(position, 1.0));
}
