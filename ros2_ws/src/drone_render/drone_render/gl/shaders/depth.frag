// Depth along the optical axis in m, and the object's label.
flat in float label;
out vec2 pixel;

void main() {
    pixel = vec2(1.0 / gl_FragCoord.w, label);
}
