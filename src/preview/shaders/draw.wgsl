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
}

@group(1) @binding(0) var<uniform> draw: Draw;

fn world_from_object(p: vec3f) -> vec3f {
    let q = vec4f(p, 1.0);
    return vec3f(dot(draw.world_row_0, q), dot(draw.world_row_1, q), dot(draw.world_row_2, q));
}

// Returns the world normal, not normalised.
fn world_normal(n: vec3f) -> vec3f {
    return vec3f(dot(draw.normal_row_0.xyz, n), dot(draw.normal_row_1.xyz, n), dot(draw.normal_row_2.xyz, n));
}
