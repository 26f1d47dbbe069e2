// Depth as a light sees it.

@group(1) @binding(0) var<uniform> view_index: vec4u;

@vertex
fn vertex(@location(0) position: vec3f, @builtin(instance_index) surface: u32) -> @builtin(position) vec4f {
    return shadow_views[view_index.x].clip_from_world * vec4f(world_from_object(surface, position), 1.0);
}
