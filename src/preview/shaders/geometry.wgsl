// The geometry pass: what each pixel shows, before any light.

override TEXTURED: bool = false;
// Factor of the depth against which surfaces hide each other: a little under 1 where paper shall lie on top.
override DEPTH_FACTOR: f32 = 1.0;

struct Corner {
    @builtin(position) clip: vec4f,
    @location(0) world: vec3f,
    @location(1) normal: vec3f,
    @location(2) uv: vec2f,
    // Packed colour, packed gloss, mark in the id buffer, and whether the front shines. Packed a corner and not a
    // pixel, which spares a software rasteriser a fifth of the pass.
    @location(3) @interpolate(flat) surface: vec4u,
}

@vertex
fn vertex(
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) uv: vec2f,
    @builtin(instance_index) s: u32,
) -> Corner {
    var out: Corner;
    out.world = world_from_object(s, position);
    out.normal = world_normal(s, normal);
    out.clip = frame.clip_from_world * vec4f(out.world, 1.0);
    out.clip.z *= DEPTH_FACTOR;
    // Textures are stored from the top.
    out.uv = vec2f(uv.x, 1.0 - uv.y);
    let flags = surfaces[s].flags;
    let glows = select(0u, 1u, (flags & FLAG_GLOWS) != 0u);
    out.surface = vec4u(
        pack_color(surfaces[s].base_color, glows),
        pack_gloss(surfaces[s].roughness, surfaces[s].metallic, surfaces[s].ior),
        (s + 1u) | mark_of(flags),
        flags & FLAG_EMITTER,
    );
    return out;
}

@group(1) @binding(0) var base_color_texture: texture_2d<f32>;
@group(1) @binding(1) var base_color_sampler: sampler;

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
    face = face * inverseSqrt(max(dot(face, face), 1e-30));
    var normal = in.normal;
    let squared = dot(normal, normal);
    // A vertex normal of zero asks for the face's; one that points away from the side that is seen is turned.
    normal = select(face, normal * inverseSqrt(max(squared, 1e-30)), squared > 1e-20);
    normal *= select(-1.0, 1.0, dot(normal, face) >= 0.0);

    // Kinds in the two upper bits: 0 lit, 1 lit and glowing, 2 emitter's front.
    var color = in.surface.x;
    if TEXTURED {
        let texel = textureSample(base_color_texture, base_color_sampler, in.uv).rgb;
        color = pack_color(unpack_color(color) * texel, color >> 30u);
    }
    color = select(color, 2u << 30u, in.surface.w != 0u && front);
    var out: Pixel;
    out.gbuffer = vec4u(pack_direction(normal), color, pack_direction(face), in.surface.y);
    // By 1/w: whatever moves the depth that hides moves no point.
    out.id = vec2u(in.surface.z, bitcast<u32>(frame.near_m * in.clip.w));
    return out;
}
