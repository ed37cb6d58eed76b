#version 330 core

in vec3 shade;

// One plane for each channel, as video frames have.
layout(location = 0) out float first;
layout(location = 1) out float second;
layout(location = 2) out float third;

void main()
{
    first = shade.x;
    second = shade.y;
    third = shade.z;
}
