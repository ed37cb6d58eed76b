#version 330 core

noperspective in vec3 shade;
out vec4 frag_color;

void main()
{
    frag_color = vec4(shade, 1.0);
}
