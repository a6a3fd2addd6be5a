#version 430 core
layout(location = 0) in vec3 position;  // metres
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 transmittance;  // of the hair, towards each light

uniform mat4 world_to_clip;

out vec3 world;
out vec3 world_normal;
out vec4 light_through;

void main() {
  world = position;
  world_normal = normal;
  light_through = transmittance;
  gl_Position = world_to_clip * vec4(position, 1.0);
}
