// A line of the overlay.
flat in vec4 line_color;
uniform float opacity;
out vec4 pixel;

void main() {
    pixel = vec4(line_color.rgb, line_color.a * opacity);
}
