// The textures of a surface; twin of `TextureSlot`, in the placements of `draw`.

@group(TEXTURE_GROUP) @binding(0) var base_color_texture: texture_2d<f32>;
@group(TEXTURE_GROUP) @binding(1) var base_color_sampler: sampler;
@group(TEXTURE_GROUP) @binding(2) var gloss_texture: texture_2d<f32>;
@group(TEXTURE_GROUP) @binding(3) var gloss_sampler: sampler;
@group(TEXTURE_GROUP) @binding(4) var emission_texture: texture_2d<f32>;
@group(TEXTURE_GROUP) @binding(5) var emission_sampler: sampler;
@group(TEXTURE_GROUP) @binding(6) var normal_texture: texture_2d<f32>;
@group(TEXTURE_GROUP) @binding(7) var normal_sampler: sampler;

const SLOT_BASE_COLOR: u32 = 0u;
const SLOT_GLOSS: u32 = 1u;
const SLOT_EMISSION: u32 = 2u;
const SLOT_NORMAL: u32 = 3u;

// Returns the coordinates of a slot's picture, from the bottom left, for both sets of texture coordinates of the mesh.
fn slot_uv(slot: u32, uvs: vec4f) -> vec2f {
    let uses_second = ((bitcast<u32>(draw.maps.w) >> slot) & 1u) != 0u;
    let uv = select(uvs.xy, uvs.zw, uses_second);
    let m = draw.uv_matrix[slot];
    let offsets = draw.uv_offset[slot >> 1u];
    return m.xy * uv.x + m.zw * uv.y + select(offsets.xy, offsets.zw, (slot & 1u) != 0u);
}

// Returns the point on the dome at texture coordinates; twin of `Dome::point_at`.
fn dome_point(uv: vec2f) -> vec2f {
    let point = uv * 2.0 - 1.0;
    return point * min(1.0, 0.999 / max(length(point), 1e-6));
}

// Returns the tangent frame of the dome at a point; twin of `Dome::frame`.
fn dome_tangents(point: vec2f) -> mat3x3f {
    let above_centre = sqrt(max(draw.dome.x * draw.dome.x - dot(point, point), 0.0));
    let normal = vec3f(point, above_centre) / draw.dome.x;
    let along_u = normalize(vec3f(above_centre, 0.0, -point.x));
    return mat3x3f(along_u, cross(normal, along_u), normal);
}

// Returns the texture coordinates that are seen at a point on the dome; twin of `Dome::seen_uv`.
fn seen_through_dome(point: vec2f, view_dir: vec3f) -> vec2f {
    let squared = draw.dome.x * draw.dome.x;
    let aside = view_dir.xy / draw.dome.y;
    let refracted = dome_tangents(point) * vec3f(-aside, -sqrt(max(1.0 - dot(aside, aside), 0.0)));
    let height = max(sqrt(max(squared - dot(point, point), 0.0)) - sqrt(squared - 1.0), 0.0);
    let seen = point + refracted.xy * (height / max(-refracted.z, 0.05));
    return seen * min(1.0, 1.0 / max(length(seen), 1e-6)) * 0.5 + 0.5;
}

// Returns coordinates as a sampler reads them: texture rows are stored from the top.
fn from_top(uv: vec2f) -> vec2f {
    return vec2f(uv.x, 1.0 - uv.y);
}

// Returns the part of the surface that covers what is behind it, for the alpha of the base colour's texture; twin of `Alpha::coverage`.
fn coverage(alpha: f32) -> f32 {
    return select(saturate(alpha * draw.maps.z), select(0.0, 1.0, alpha >= draw.maps.y), draw.maps.y >= 0.0);
}

// Returns the coverage from which on a pixel shows a blended surface: a Bayer matrix of 4 x 4.
fn screen_threshold(pixel: vec2u) -> f32 {
    let row = array<u32, 4>(0xa280u, 0x6e4cu, 0x91b3u, 0x5d7fu)[pixel.y & 3u];
    return (f32((row >> ((pixel.x & 3u) * 4u)) & 15u) + 0.5) / 16.0;
}
