// The shadow map pass of strands: a ribbon that faces the light, an instance a segment.

struct View {
    clip_from_world: mat4x4f,
}

@group(2) @binding(0) var<uniform> view: View;

// Factor on the width: see `StrandShadows` in `strands.rs`.
override SHADOW_WIDTH: f32 = 1.0;

@vertex
fn vertex(
    @builtin(vertex_index) corner: u32,
    @location(1) first: vec4f,
    @location(2) second: vec4f,
) -> @builtin(position) vec4f {
    let at_end = corner >= 2u;
    let m = view.clip_from_world;
    let clip_a = m * vec4f(world_from_object(first.xyz), 1.0);
    let clip_b = m * vec4f(world_from_object(second.xyz), 1.0);
    let clip = select(clip_a, clip_b, at_end);
    // Metres per unit of the image plane along both axes
    let scale = vec2f(length(vec3f(m[0].x, m[1].x, m[2].x)), length(vec3f(m[0].y, m[1].y, m[2].y)));
    let along = (clip_b.xy / max(clip_b.w, 1e-4) - clip_a.xy / max(clip_a.w, 1e-4)) / scale;
    let across = vec2f(-along.y, along.x) * inverseSqrt(max(dot(along, along), 1e-20));
    let object_scale = pow(abs(determinant(mat3x3f(draw.world_row_0.xyz, draw.world_row_1.xyz, draw.world_row_2.xyz))), 1.0 / 3.0);
    let radius = abs(select(first.w, second.w, at_end)) * object_scale * SHADOW_WIDTH;
    let side = select(-radius, radius, (corner & 1u) == 1u);
    let widened = clip + vec4f(across * side * scale, 0.0, 0.0);
    return select(widened, vec4f(0.0, 0.0, -1.0, 1.0), first.w < 0.0 || min(clip_a.w, clip_b.w) <= 0.0);
}
