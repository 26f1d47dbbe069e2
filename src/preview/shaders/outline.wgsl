// The selection outline: two pixels around selected surfaces, paler around the hovered one.

@group(1) @binding(0) var gbuffer: texture_2d<u32>;
@group(1) @binding(1) var ids: texture_2d<u32>;

const SELECTED_COLOR: vec3f = vec3f(1.0, 0.66, 0.16);
const HOVERED_COLOR: vec3f = vec3f(0.92, 0.94, 0.98);

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return fullscreen_corner(index);
}

@fragment
fn fragment(@builtin(position) at: vec4f) -> @location(0) vec4f {
    let pixel = vec2i(at.xy);
    let last = vec2i(frame.size) - 1;
    let own = textureLoad(ids, pixel, 0).x;
    // Coverage of the selected and of the hovered outline.
    var cover = vec2f(0.0);
    for (var y = -2; y <= 2; y++) {
        for (var x = -2; x <= 2; x++) {
            let id = textureLoad(ids, clamp(pixel + vec2i(x, y), vec2i(0), last), 0).x;
            let near = saturate(2.6 - length(vec2f(f32(x), f32(y))));
            let is_outlined = vec2f(f32((id & ID_SELECTED) != 0u), f32((id & ID_HOVERED) != 0u));
            cover = max(cover, is_outlined * near);
        }
    }
    let inside = vec2f(f32((own & ID_SELECTED) != 0u), f32((own & ID_HOVERED) != 0u));
    cover *= 1.0 - inside;
    let hovered = cover.y * 0.6 * (1.0 - cover.x);
    let alpha = cover.x + hovered;
    return vec4f((SELECTED_COLOR * cover.x + HOVERED_COLOR * hovered) / max(alpha, 1e-4), alpha);
}
