#version 330 core

// The background's light on the ground, under ellipses that are darkest at their centres.

in vec2 place;

layout(location = 0) out float first;
layout(location = 1) out float second;
layout(location = 2) out float third;

uniform mat4 channels;
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
    vec4 shade = channels * vec4(background * light, 1.0);
    first = shade.x;
    second = shade.y;
    third = shade.z;
}
