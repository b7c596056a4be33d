// How far away a thing is along the optical axis, in m, and its number.
flat in float number;
out vec2 pixel;

void main() {
    pixel = vec2(1.0 / gl_FragCoord.w, number);
}
