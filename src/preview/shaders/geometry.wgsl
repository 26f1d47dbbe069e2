// The geometry pass: writes the G-buffer and the id buffer.

// Textures that are sampled: 0 none, 1 the base colour's, 2 all.
override TEXTURES: u32 = 0;
// Discards what is not there of a surface.
override HOLES: bool = false;
// Factor of the depth that is tested: slightly under 1 for the room, so that paper on its floor wins.
override DEPTH_FACTOR: f32 = 1.0;

struct VertexOutput {
    @builtin(position) clip: vec4f,
    @location(0) world: vec3f,
    @location(1) normal: vec3f,
    // Both sets of texture coordinates.
    @location(2) uvs: vec4f,
    @location(3) color: vec3f,
}

@vertex
fn vertex(
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) uv: vec2f,
    @location(3) color: vec4f,
    @location(4) second_uv: vec2f,
) -> VertexOutput {
    var out: VertexOutput;
    out.world = world_from_object(position);
    out.normal = world_normal(normal);
    out.clip = frame.clip_from_world * vec4f(out.world, 1.0);
    out.clip.z *= DEPTH_FACTOR;
    out.uvs = vec4f(uv, second_uv);
    out.color = color.rgb;
    return out;
}

struct FragmentOutput {
    @location(0) gbuffer: vec4u,
    // Surface index plus one with outline flags, and the bits of the depth.
    @location(1) id: vec2u,
}

// Returns the tangent frame of a normal; twin of `math::tangent_frame`. `d1` and `d2` are differences of the position,
// `duv1` and `duv2` those of the picture's coordinates. Its tangents are zero where it is degenerate.
fn tangent_frame(normal: vec3f, d1: vec3f, d2: vec3f, duv1: vec2f, duv2: vec2f) -> mat3x3f {
    let determinant = duv1.x * duv2.y - duv1.y * duv2.x;
    let side = select(-1.0, 1.0, determinant >= 0.0);
    let du = (d1 * duv2.y - d2 * duv1.y) * side;
    let dv = (d2 * duv1.x - d1 * duv2.x) * side;
    let along = du - normal * dot(normal, du);
    let squared = dot(along, along);
    let usable = abs(determinant) > 1e-30 && squared > 1e-37;
    let tangent = along * select(0.0, inverseSqrt(max(squared, 1e-37)), usable);
    var bitangent = cross(normal, tangent);
    bitangent *= select(-1.0, 1.0, dot(bitangent, dv) >= 0.0);
    return mat3x3f(tangent, bitangent, normal);
}

// Returns a direction of tangent space as a normal; twin of `math::tilted_normal`.
fn tilted_normal(frame: mat3x3f, direction: vec3f) -> vec3f {
    let tilted = frame * direction;
    let squared = dot(tilted, tilted);
    return select(frame[2], tilted * inverseSqrt(max(squared, 1e-12)), squared > 1e-12);
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
    var gloss = draw.surface.y;
    var uvs = in.uvs;
    let d1 = dpdx(in.world);
    let d2 = dpdy(in.world);
    let has_dome = TEXTURES > 1u && draw.dome.x > 0.0;
    var world_from_base = mat3x3f();
    if TEXTURES > 1u {
        // Under a dome the textures are seen by refraction
        let frame = tangent_frame(normalize(normal), d1, d2, dpdx(in.uvs.xy), dpdy(in.uvs.xy));
        let point = dome_point(in.uvs.xy);
        world_from_base = frame * transpose(dome_tangents(point));
        let seen = vec4f(seen_through_dome(point, normalize(to_eye) * frame), in.uvs.zw);
        uvs = select(in.uvs, seen, has_dome);
    }
    if TEXTURES > 0u {
        let texel = textureSample(base_color_texture, base_color_sampler, from_top(slot_uv(SLOT_BASE_COLOR, uvs)));
        color = pack_color(unpack_color(color) * texel.rgb, color >> 30u);
        if HOLES {
            if coverage(texel.a) <= screen_threshold(vec2u(in.clip.xy)) {
                discard;
            }
        }
    }
    if TEXTURES > 1u {
        // Roughness and metal, and what glows of a surface
        let factors = textureSample(gloss_texture, gloss_sampler, from_top(slot_uv(SLOT_GLOSS, uvs))).rgb;
        let glow = textureSample(emission_texture, emission_sampler, from_top(slot_uv(SLOT_EMISSION, uvs))).rgb;
        let glows = color >> 30u == 1u;
        let values = select(unpack_gloss(gloss), unpack_glowing_gloss(gloss, 0.0), glows) * vec3f(factors.g, 1.0, factors.b);
        gloss = select(pack_gloss(values), pack_glowing_gloss(values, glow), glows);
        // The normal map
        let texel = textureSample(normal_texture, normal_sampler, from_top(slot_uv(SLOT_NORMAL, uvs))).rgb * 2.0 - 1.0;
        let direction = vec3f(texel.xy * draw.maps.x, texel.z);
        let normal_uv = slot_uv(SLOT_NORMAL, in.uvs);
        let frame = tangent_frame(normalize(normal), d1, d2, dpdx(normal_uv), dpdy(normal_uv));
        let tilted = select(tilted_normal(frame, direction), tilted_normal(world_from_base, direction), has_dome);
        // It is bent towards the viewer where the lighting pass needs that
        // A smooth gloss keeps the normal that it has, in the place of the geometric one
        geometric_normal = select(geometric_normal, normal, (bitcast<u32>(draw.maps.w) & SMOOTH_GLOSS_BIT) != 0u);
        normal = select(normal, tilted, draw.maps.x != 0.0 || has_dome);
    }
    if any(in.color < vec3f(0.999)) && !has_dome {
        color = pack_color(unpack_color(color) * in.color, color >> 30u);
    }
    color = select(color, 2u << 30u, draw.surface.w != 0u && front);
    var out: FragmentOutput;
    out.gbuffer = vec4u(pack_direction(normal), color, pack_direction(geometric_normal), gloss);
    // Derive the stored depth from 1/w, which DEPTH_FACTOR does not change
    out.id = vec2u(draw.surface.z, bitcast<u32>(frame.near_m * in.clip.w));
    return out;
}
