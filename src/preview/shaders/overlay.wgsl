// The overlay pass: lines and tinted triangles, drawn faintly where the depth in the id buffer hides them.

@group(1) @binding(0) var gbuffer: texture_2d<u32>;
@group(1) @binding(1) var ids: texture_2d<u32>;

struct VertexOutput {
    @builtin(position) clip: vec4f,
    @location(0) color: vec4f,
    @location(1) @interpolate(flat) through: f32,
    // Distance from the line's axis and half its width, pixels.
    @location(2) @interpolate(linear) across: f32,
    @location(3) @interpolate(flat) half_width: f32,
}

// Expands a line to a quad of constant width on the screen, six vertices.
@vertex
fn line_vertex(
    @builtin(vertex_index) index: u32,
    @location(0) start: vec4f,
    @location(1) end: vec4f,
    @location(2) color: vec4f,
) -> VertexOutput {
    var a = frame.clip_from_world * vec4f(start.xyz, 1.0);
    var b = frame.clip_from_world * vec4f(end.xyz, 1.0);
    let near = frame.near_m * 2.0;
    var out: VertexOutput;
    if max(a.w, b.w) < near {
        out.clip = vec4f(0.0, 0.0, -1.0, 1.0);
        return out;
    }
    // Clip at the near plane before the perspective division
    if a.w < near {
        a = mix(a, b, (near - a.w) / (b.w - a.w));
    }
    if b.w < near {
        b = mix(b, a, (near - b.w) / (a.w - b.w));
    }
    let pixel_a = a.xy / a.w * frame.size * 0.5;
    let pixel_b = b.xy / b.w * frame.size * 0.5;
    let along = pixel_b - pixel_a;
    let direction = select(vec2f(1.0, 0.0), along / max(length(along), 1e-6), length(along) > 1e-6);
    let side = vec2f(-direction.y, direction.x);
    // Vertices in the order of two triangles: 0 1 2, 2 1 3
    let corner = select(index, array(2u, 1u, 3u)[index % 3u], index >= 3u);
    let half_width = 0.5 * start.w;
    let reach = half_width + 1.0;
    let sign = select(-1.0, 1.0, (corner & 1u) == 1u);
    let at_end = corner >= 2u;
    let end_point = select(a, b, at_end);
    let pixel = select(pixel_a - direction * 0.5, pixel_b + direction * 0.5, at_end) + side * sign * reach;
    out.clip = vec4f(pixel / (frame.size * 0.5) * end_point.w, end_point.z, end_point.w);
    out.color = color;
    out.through = end.w;
    out.across = sign * reach;
    out.half_width = half_width;
    return out;
}

@vertex
fn tint_vertex(@location(0) position: vec4f, @location(1) color: vec4f) -> VertexOutput {
    var out: VertexOutput;
    out.clip = frame.clip_from_world * vec4f(position.xyz, 1.0);
    out.color = color;
    out.through = position.w;
    out.half_width = 1.0;
    return out;
}

@fragment
fn fragment(in: VertexOutput) -> @location(0) vec4f {
    let depth = bitcast<f32>(textureLoad(ids, vec2i(in.clip.xy), 0).y);
    // Depth bias of 0.5 % of the distance, so that lines on a floor stay visible, but 5 cm at most: a parallel view
    // looks from two kilometres away
    let margin = min(1.005, 1.0 + 0.05 * in.clip.z / frame.near_m);
    let shown = select(in.through, 1.0, in.clip.z * margin >= depth);
    let edge = saturate(in.half_width + 0.5 - abs(in.across));
    return vec4f(in.color.rgb, in.color.a * shown * edge);
}
