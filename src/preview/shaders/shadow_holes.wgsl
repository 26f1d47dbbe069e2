// The shadow map pass of masked and blended surfaces.

struct View {
    clip_from_world: mat4x4f,
}

@group(2) @binding(0) var<uniform> view: View;

struct HoleVertex {
    @builtin(position) clip: vec4f,
    @location(0) uvs: vec4f,
}

@vertex
fn vertex_with_holes(
    @location(0) position: vec3f,
    @location(2) uv: vec2f,
    @location(4) second_uv: vec2f,
) -> HoleVertex {
    return HoleVertex(view.clip_from_world * vec4f(world_from_object(position), 1.0), vec4f(uv, second_uv));
}

@fragment
fn fragment_with_holes(in: HoleVertex) {
    let uv = from_top(slot_uv(SLOT_BASE_COLOR, in.uvs));
    let alpha = textureSample(base_color_texture, base_color_sampler, uv).a;
    if coverage(alpha) <= screen_threshold(vec2u(in.clip.xy)) {
        discard;
    }
}
