#version 330 core

// What is left of the background's light on the ground, under ellipses that darken towards their
// centres.

in vec2 place;
out vec4 frag_color;

uniform vec3 background;
uniform vec2 centres[ELLIPSES];
uniform mat2 into_circle[ELLIPSES];
uniform float darkness[ELLIPSES];

void main()
{
    float light = 1.0;
    for (int i = 0; i < ELLIPSES; i++) {
        vec2 inside = into_circle[i] * (place - centres[i]);
        float depth = max(1.0 - dot(inside, inside), 0.0);
        light *= 1.0 - darkness[i] * depth * depth;
    }
    frag_color = vec4(background * light, 1.0);
}
