// The shadow map pass: depth from a light.

struct View {
    clip_from_world: mat4x4f,
}

@group(2) @binding(0) var<uniform> view: View;

@vertex
fn vertex(@location(0) position: vec3f) -> @builtin(position) vec4f {
    return view.clip_from_world * vec4f(world_from_object(position), 1.0);
}
