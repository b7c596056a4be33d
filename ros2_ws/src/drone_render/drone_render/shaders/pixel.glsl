// What a pixel is made of: its colour and, where edges are smoothed, a mark that tells neighbouring surfaces apart.
#ifdef EDGES
out vec4 pixel;

void put(vec3 colour) {
    pixel = vec4(colour, facet.mark);
}
#else
out vec3 pixel;

void put(vec3 colour) {
    pixel = colour;
}
#endif
