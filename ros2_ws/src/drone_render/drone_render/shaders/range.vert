in vec3 position;
in mat4 model;
in float mark;  // here the thing's number, from 1
uniform mat4 view_projection;
flat out float number;

void main() {
    number = mark;
    gl_Position = view_projection * (model * vec4(position, 1.0));
}
