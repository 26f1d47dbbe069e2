// What one draw reads: where its triangles stand and what they are made of; twin of `GpuDraw`.

struct Draw {
    world_row_0: vec4f,
    world_row_1: vec4f,
    world_row_2: vec4f,
    normal_row_0: vec4f,
    normal_row_1: vec4f,
    normal_row_2: vec4f,
    // Packed colour, packed gloss, mark in the id buffer, and whether the front shines.
    surface: vec4u,
}

@group(1) @binding(0) var<uniform> draw: Draw;

fn world_from_object(p: vec3f) -> vec3f {
    let q = vec4f(p, 1.0);
    return vec3f(dot(draw.world_row_0, q), dot(draw.world_row_1, q), dot(draw.world_row_2, q));
}

// Not of unit length.
fn world_normal(n: vec3f) -> vec3f {
    return vec3f(dot(draw.normal_row_0.xyz, n), dot(draw.normal_row_1.xyz, n), dot(draw.normal_row_2.xyz, n));
}
