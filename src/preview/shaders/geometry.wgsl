// The geometry pass: writes the G-buffer and the id buffer.

override TEXTURED: bool = false;
// Factor of the depth that is tested: slightly under 1 for the room, so that paper on its floor wins.
override DEPTH_FACTOR: f32 = 1.0;

struct VertexOutput {
    @builtin(position) clip: vec4f,
    @location(0) world: vec3f,
    @location(1) normal: vec3f,
    @location(2) uv: vec2f,
    @location(3) color: vec3f,
}

@vertex
fn vertex(
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) uv: vec2f,
    @location(3) color: vec4f,
) -> VertexOutput {
    var out: VertexOutput;
    out.world = world_from_object(position);
    out.normal = world_normal(normal);
    out.clip = frame.clip_from_world * vec4f(out.world, 1.0);
    out.clip.z *= DEPTH_FACTOR;
    // Texture rows are stored from the top
    out.uv = vec2f(uv.x, 1.0 - uv.y);
    out.color = color.rgb;
    return out;
}

@group(2) @binding(0) var base_color_texture: texture_2d<f32>;
@group(2) @binding(1) var base_color_sampler: sampler;

struct FragmentOutput {
    @location(0) gbuffer: vec4u,
    // Surface index plus one with outline flags, and the bits of the depth.
    @location(1) id: vec2u,
}

@fragment
fn fragment(in: VertexOutput, @builtin(front_facing) front: bool) -> FragmentOutput {
    let to_eye = frame.eye - in.world;
    var geometric_normal = cross(dpdx(in.world), dpdy(in.world));
    geometric_normal *= select(-1.0, 1.0, dot(geometric_normal, to_eye) >= 0.0);
    // Use the geometric normal where the vertex normal is zero, and flip normals towards the visible side. Packing
    // accepts directions of any length
    var normal = select(geometric_normal, in.normal, dot(in.normal, in.normal) > 1e-20);
    normal *= select(-1.0, 1.0, dot(normal, geometric_normal) >= 0.0);

    // Surface kind in the two upper bits: 0 lit, 1 lit and emissive, 2 the front of an emitter
    var color = draw.surface.x;
    if TEXTURED {
        let texel = textureSample(base_color_texture, base_color_sampler, in.uv).rgb;
        color = pack_color(unpack_color(color) * texel, color >> 30u);
    }
    if any(in.color < vec3f(0.999)) {
        color = pack_color(unpack_color(color) * in.color, color >> 30u);
    }
    color = select(color, 2u << 30u, draw.surface.w != 0u && front);
    var out: FragmentOutput;
    out.gbuffer = vec4u(pack_direction(normal), color, pack_direction(geometric_normal), draw.surface.y);
    // Derive the stored depth from 1/w, which DEPTH_FACTOR does not change
    out.id = vec2u(draw.surface.z, bitcast<u32>(frame.near_m * in.clip.w));
    return out;
}
