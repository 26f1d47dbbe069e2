// The geometry pass: what each pixel shows, before any light.

override TEXTURED: bool = false;
// Factor of the depth against which surfaces hide each other: a little under 1 where paper shall lie on top.
override DEPTH_FACTOR: f32 = 1.0;

struct Corner {
    @builtin(position) clip: vec4f,
    @location(0) world: vec3f,
    @location(1) normal: vec3f,
    @location(2) uv: vec2f,
}

@vertex
fn vertex(
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) uv: vec2f,
) -> Corner {
    var out: Corner;
    out.world = world_from_object(position);
    out.normal = world_normal(normal);
    out.clip = frame.clip_from_world * vec4f(out.world, 1.0);
    out.clip.z *= DEPTH_FACTOR;
    // Textures are stored from the top.
    out.uv = vec2f(uv.x, 1.0 - uv.y);
    return out;
}

@group(2) @binding(0) var base_color_texture: texture_2d<f32>;
@group(2) @binding(1) var base_color_sampler: sampler;

struct Pixel {
    @location(0) gbuffer: vec4u,
    // Surface number plus one with its marks, and the depth's bits.
    @location(1) id: vec2u,
}

@fragment
fn fragment(in: Corner, @builtin(front_facing) front: bool) -> Pixel {
    let to_eye = frame.eye - in.world;
    var face = cross(dpdx(in.world), dpdy(in.world));
    face *= select(-1.0, 1.0, dot(face, to_eye) >= 0.0);
    // A vertex normal of zero asks for the face's; one that points away from the side that is seen is turned. Packing
    // takes directions of any length.
    var normal = select(face, in.normal, dot(in.normal, in.normal) > 1e-20);
    normal *= select(-1.0, 1.0, dot(normal, face) >= 0.0);

    // Kinds in the two upper bits: 0 lit, 1 lit and glowing, 2 emitter's front.
    var color = draw.surface.x;
    if TEXTURED {
        let texel = textureSample(base_color_texture, base_color_sampler, in.uv).rgb;
        color = pack_color(unpack_color(color) * texel, color >> 30u);
    }
    color = select(color, 2u << 30u, draw.surface.w != 0u && front);
    var out: Pixel;
    out.gbuffer = vec4u(pack_direction(normal), color, pack_direction(face), draw.surface.y);
    // By 1/w: whatever moves the depth that hides moves no point.
    out.id = vec2u(draw.surface.z, bitcast<u32>(frame.near_m * in.clip.w));
    return out;
}
