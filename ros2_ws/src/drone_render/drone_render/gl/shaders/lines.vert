// A line as a strip of two triangles with a constant width in pixels; one instance for each line.
in vec3 start;
in vec3 end;
in vec4 color;
uniform mat4 view_projection;
uniform vec2 size;   // of the picture, pixels
uniform float width; // of the line, pixels
uniform float near;  // m
flat out vec4 line_color;

void main() {
    vec4 a = view_projection * vec4(start, 1.0);
    vec4 b = view_projection * vec4(end, 1.0);
    // Points behind the camera cannot be projected: clip the line at the near plane.
    if (a.w < near) a = mix(a, b, clamp((near - a.w) / max(b.w - a.w, 1e-6), 0.0, 1.0));
    if (b.w < near) b = mix(b, a, clamp((near - b.w) / max(a.w - b.w, 1e-6), 0.0, 1.0));
    vec2 along = (b.xy / b.w - a.xy / a.w) * size;
    vec2 across = vec2(-along.y, along.x) * inversesqrt(max(dot(along, along), 1e-9)) * width;
    vec4 here = gl_VertexID < 2 ? a : b;
    float side = (gl_VertexID & 1) == 0 ? 1.0 : -1.0;
    gl_Position = here + vec4(across * side / size * here.w, 0.0, 0.0);
    line_color = color;
}
