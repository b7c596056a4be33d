flat in vec4 line_colour;
uniform float share;
out vec4 pixel;

void main() {
    pixel = vec4(line_colour.rgb, line_colour.a * share);
}
