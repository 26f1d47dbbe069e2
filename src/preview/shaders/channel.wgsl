// The channel pass: one channel of the G-buffer as a picture.

// The values of `channel::Channel`.
override CHANNEL: u32 = 1;
// Writes raw values: depth in metres, normals from -1 to 1.
override LINEAR: bool = false;

const BASE_COLOR: u32 = 1u;
const NORMAL: u32 = 2u;
const ROUGHNESS: u32 = 3u;
const METALLIC: u32 = 4u;
const DEPTH: u32 = 5u;
const IDS: u32 = 6u;

@group(1) @binding(0) var gbuffer: texture_2d<u32>;
@group(1) @binding(1) var ids: texture_2d<u32>;

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return fullscreen_corner(index);
}

// Returns a bright colour per id; hues of consecutive ids differ by the golden angle.
fn id_color(id: u32) -> vec3f {
    let hue = fract(f32(id) * 0.618034);
    let wheel = abs(fract(hue + vec3f(0.0, 2.0 / 3.0, 1.0 / 3.0)) * 6.0 - 3.0) - 1.0;
    return mix(vec3f(1.0), saturate(wheel), 0.7) * (0.65 + 0.3 * fract(f32(id) * 0.381966));
}

@fragment
fn fragment(@builtin(position) at: vec4f) -> @location(0) vec4f {
    let pixel = vec2u(at.xy);
    let packed = textureLoad(gbuffer, pixel, 0);
    let id = textureLoad(ids, pixel, 0).xy;
    let gloss = gloss_at(packed, id.x);
    let depth_m = frame.near_m / max(bitcast<f32>(id.y), 1e-9);
    var value = vec3f(0.0);
    if CHANNEL == BASE_COLOR {
        let color = unpack_color(packed.y);
        value = color;
        if !LINEAR {
            value = srgb_encode(color);
        }
    }
    if CHANNEL == NORMAL {
        let normal = unpack_direction(packed.x);
        // 0 is code 128 of 255: half of the range lies between two codes, and adapters round it either way
        value = select((128.0 + 127.0 * normal) / 255.0, normal, LINEAR);
    }
    if CHANNEL == ROUGHNESS {
        value = vec3f(gloss.x);
    }
    if CHANNEL == METALLIC {
        value = vec3f(gloss.z);
    }
    if CHANNEL == DEPTH {
        var shade = 1.0 - log2(max(depth_m, 1e-3) / 0.5) / 6.0;
        let range = frame.depth_range_m;
        if range.y > range.x {
            shade = (range.y - depth_m) / (range.y - range.x);
        }
        value = vec3f(select(saturate(shade), depth_m, LINEAR));
    }
    if CHANNEL == IDS {
        value = id_color(id.x & ID_INDEX_MASK);
    }
    return vec4f(select(value, vec3f(0.0), (id.x & ID_INDEX_MASK) == 0u), 1.0);
}
