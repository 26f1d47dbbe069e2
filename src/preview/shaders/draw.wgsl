// The record of one draw call: transforms and packed surface; twin of `GpuDraw`.

struct Draw {
    world_row_0: vec4f,
    world_row_1: vec4f,
    world_row_2: vec4f,
    normal_row_0: vec4f,
    normal_row_1: vec4f,
    normal_row_2: vec4f,
    // Packed colour, packed gloss, id with outline flags, and 1 for an emitter.
    surface: vec4u,
    // Transforms of texture coordinates by slot: the columns of the matrix, and the offsets of two slots each.
    uv_matrix: array<vec4f, 4>,
    uv_offset: array<vec4f, 2>,
    // Scale of the normal map; least alpha that is there, negative for blended surfaces; factor of the alpha of those; bits
    // of the slots that lie by the second set of texture coordinates, and of a smooth gloss.
    maps: vec4f,
    // Radius of the dome over the textures, 0 for none; its index of refraction; two unused.
    dome: vec4f,
}

// Bit of a surface whose relief is below the gloss; twin of `gpu_maps.rs`.
const SMOOTH_GLOSS_BIT: u32 = 256u;

@group(1) @binding(0) var<uniform> draw: Draw;

fn world_from_object(p: vec3f) -> vec3f {
    let q = vec4f(p, 1.0);
    return vec3f(dot(draw.world_row_0, q), dot(draw.world_row_1, q), dot(draw.world_row_2, q));
}

// Returns the world normal, not normalised.
fn world_normal(n: vec3f) -> vec3f {
    return vec3f(dot(draw.normal_row_0.xyz, n), dot(draw.normal_row_1.xyz, n), dot(draw.normal_row_2.xyz, n));
}
