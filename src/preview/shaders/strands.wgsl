// The geometry pass of strands: a ribbon that faces the camera, an instance a segment.

// Least half width of a ribbon, pixels. `visible` in `draw_item.rs` drops strands to make up for it.
const MIN_HALF_WIDTH: f32 = 0.5;

struct VertexOutput {
    @builtin(position) clip: vec4f,
    @location(0) world: vec3f,
    @location(1) tangent: vec3f,
}

// Positions and radii of the points before, at and after the segment; the radius of a strand's last point is negative.
@vertex
fn vertex(
    @builtin(vertex_index) corner: u32,
    @location(0) before: vec4f,
    @location(1) first: vec4f,
    @location(2) second: vec4f,
    @location(3) after: vec4f,
) -> VertexOutput {
    var out: VertexOutput;
    let at_end = corner >= 2u;
    let a = world_from_object(first.xyz);
    let b = world_from_object(second.xyz);
    let chord = b - a;
    // Interpolate the direction between segments
    let start_direction = select(b - world_from_object(before.xyz), chord, before.w < 0.0);
    let end_direction = select(world_from_object(after.xyz) - a, chord, second.w < 0.0);
    out.tangent = select(start_direction, end_direction, at_end);
    out.world = select(a, b, at_end);
    // Widen the segment on the screen
    let clip_a = frame.clip_from_world * vec4f(a, 1.0);
    let clip_b = frame.clip_from_world * vec4f(b, 1.0);
    let clip = select(clip_a, clip_b, at_end);
    let along = (clip_b.xy / max(clip_b.w, 1e-4) - clip_a.xy / max(clip_a.w, 1e-4)) * frame.size;
    let across = vec2f(-along.y, along.x) * inverseSqrt(max(dot(along, along), 1e-12));
    let scale = pow(abs(determinant(mat3x3f(draw.world_row_0.xyz, draw.world_row_1.xyz, draw.world_row_2.xyz))), 1.0 / 3.0);
    let radius_px = abs(select(first.w, second.w, at_end)) * scale / (2.0 * frame.pixel_angle * max(clip.w, 1e-4));
    let side = select(-1.0, 1.0, (corner & 1u) == 1u) * max(radius_px * frame.strand_width, MIN_HALF_WIDTH);
    out.clip = clip + vec4f(across * side * (2.0 / frame.size) * clip.w, 0.0, 0.0);
    // Drop the gap between two strands, and segments behind the eye
    if first.w < 0.0 || min(clip_a.w, clip_b.w) < frame.near_m {
        out.clip = vec4f(0.0, 0.0, -1.0, 1.0);
    }
    return out;
}

struct FragmentOutput {
    @location(0) gbuffer: vec4u,
    @location(1) id: vec2u,
}

@fragment
fn fragment(in: VertexOutput) -> FragmentOutput {
    let to_eye = frame.eye - in.world;
    let tangent = normalize(in.tangent);
    let facing = to_eye - tangent * dot(tangent, to_eye);
    var out: FragmentOutput;
    // Surface kind 3: the first direction is the tangent
    let color = (draw.surface.x & 0x3fffffffu) | (3u << 30u);
    out.gbuffer = vec4u(pack_direction(tangent), color, pack_direction(facing + to_eye * 1e-4), draw.surface.y);
    out.id = vec2u(draw.surface.z, bitcast<u32>(frame.near_m * in.clip.w));
    return out;
}
