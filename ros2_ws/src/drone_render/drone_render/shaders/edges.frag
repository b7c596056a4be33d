// Smooths the steps where two surfaces meet: a pixel takes a share of each of its four neighbours of another mark.
// Textures stay sharp, as a surface has one mark.
uniform sampler2D picture;
out vec3 pixel;

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    ivec2 last = textureSize(picture, 0) - 1;
    vec4 here = texelFetch(picture, at, 0);
    vec4 left = texelFetch(picture, ivec2(max(at.x - 1, 0), at.y), 0);
    vec4 right = texelFetch(picture, ivec2(min(at.x + 1, last.x), at.y), 0);
    vec4 above = texelFetch(picture, ivec2(at.x, max(at.y - 1, 0)), 0);
    vec4 below = texelFetch(picture, ivec2(at.x, min(at.y + 1, last.y)), 0);
    vec4 other = 0.2 * vec4(notEqual(vec4(left.a, right.a, above.a, below.a), here.aaaa));
    pixel = here.rgb * (1.0 - dot(other, vec4(1.0)))
        + left.rgb * other.x + right.rgb * other.y + above.rgb * other.z + below.rgb * other.w;
}
