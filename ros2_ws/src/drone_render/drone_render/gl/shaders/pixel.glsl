// Output of a pixel: its color and, with antialiasing, the mark of its surface.
#ifdef EDGES
out vec4 pixel;

void put(vec3 color) {
    pixel = vec4(color, facet.mark);
}
#else
out vec3 pixel;

void put(vec3 color) {
    pixel = color;
}
#endif
