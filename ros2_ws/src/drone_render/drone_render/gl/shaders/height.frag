// Height of the land above z = 0, in m.
in float height;
out float pixel;

void main() {
    pixel = height;
}
