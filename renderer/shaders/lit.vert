#version 330 core

// Lighting per vertex: the avatar's triangles are a few pixels wide, so shading each pixel looks
// the same and costs several times as much.

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 color_0;  // sRGB colour; alpha is the gloss

struct DirectionalLight {
    vec3 color;
    float intensity;
    vec3 direction;
};

uniform mat4 projection;
uniform vec3 cam_pos;
uniform vec3 ambient_light;
uniform int n_directional_lights;
uniform DirectionalLight directional_lights[MAX_LIGHTS];

uniform mat4 channels;  // from red, green and blue to the drawn channels

out vec3 shade;

const float WRAP = 0.25;

void main()
{
    gl_Position = projection * vec4(position, 1.0);
    vec3 n = normalize(normal);
    vec3 to_eye = normalize(cam_pos - position);
    vec3 albedo = color_0.rgb * color_0.rgb;  // gamma 2 looks like 2.2 and is cheaper
    vec3 light = ambient_light * (0.8 + 0.2 * n.y);
    float gleam = 0.0;
    for (int i = 0; i < n_directional_lights; i++) {
        vec3 l = -normalize(directional_lights[i].direction);
        float facing = max((dot(n, l) + WRAP) / (1.0 + WRAP), 0.0);
        light += directional_lights[i].intensity * directional_lights[i].color * facing * facing;
        float mirrored = max(dot(n, normalize(l + to_eye)), 0.0);
        float power4 = mirrored * mirrored * mirrored * mirrored;
        float power8 = power4 * power4;
        gleam += directional_lights[i].intensity * power8 * power8 * power8;
    }
    vec3 rgb = sqrt(min(albedo * light + vec3(color_0.a * gleam), vec3(1.0)));
    shade = (channels * vec4(rgb, 1.0)).xyz;
}
