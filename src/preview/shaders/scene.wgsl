// Bindings that all passes share (frame constants, surfaces, lights, light tiles) and the packing of the G-buffer.

const PI: f32 = 3.14159265;

struct Frame {
    clip_from_world: mat4x4f,
    eye: vec3f,
    near_m: f32,
    // World directions: through the picture's centre (1 m along the optical axis), half a picture right, half a picture
    // up.
    ray_centre: vec3f,
    // Picture pixels per shadow mask pixel along each axis.
    mask_scale: u32,
    ray_right: vec3f,
    // Picture pixels per coarse pixel along each axis, in drafts.
    coarse_scale: u32,
    ray_up: vec3f,
    // Factor on the width of strands, of which fewer are drawn: see `visible` in `draw_item.rs`.
    strand_width: f32,
    // Ambient irradiance, picture units.
    ambient: vec3f,
    // Half width of a pixel at distance 1 m.
    pixel_angle: f32,
    // Radiance of the background.
    void_radiance: vec3f,
    unused_3: f32,
    // The environment box around the subjects, and the radiance of its faces +X, -X, +Y, -Y, +Z, -Z in reflections.
    environment_low: vec3f,
    unused_0: f32,
    environment_high: vec3f,
    unused_1: f32,
    environment_radiance: array<vec4f, 6>,
    // Position of the first probe of the bounced light.
    grid_low: vec3f,
    unused_4: f32,
    // Probes per metre along each axis.
    grid_density: vec3f,
    unused_5: f32,
    // Number of probes along each axis.
    grid_counts: vec3f,
    // Distance from a surface at which its bounced light is looked up, metres.
    grid_offset_m: f32,
    size: vec2f,
    // Distances shown as white and as black by the depth channel, metres; both 0 for a perspective view.
    depth_range_m: vec2f,
    // One past the last light of each kind: points, spots and suns; spheres; rectangles; discs. Lights are sorted by
    // kind.
    light_ends: vec4u,
}

// A fibre has its absorption per radius as base colour, its longitudinal variance as roughness, its azimuthal scale as
// metallic.
struct Surface {
    base_color: vec3f,
    roughness: f32,
    emission: vec3f,
    metallic: f32,
    ior: f32,
    transmission: f32,
    flags: u32,
    // Amount and roughness of lacquer, translucency, frosting, 8 bits each.
    layers: u32,
    // Shape parameters of the diffusion profile, metres: red, green, blue; 0 for hard surfaces.
    diffusion_m: vec3f,
    unused_1: u32,
}

// Flag of a surface with a normal map.
const FLAG_RELIEF: u32 = 16u;
// Flag of a surface whose normal map is below the gloss.
const FLAG_SMOOTH_GLOSS: u32 = 32u;
// Flag of strands so short that light from behind meets what they grow from.
const FLAG_SHORT_FIBRE: u32 = 64u;

// Outline flags in the id buffer; the other bits hold the surface index plus one, 0 for the background.
const ID_SELECTED: u32 = 1u << 31u;
const ID_HOVERED: u32 = 1u << 30u;
const ID_INDEX_MASK: u32 = ID_HOVERED - 1u;
// Sign bit of the depth in a shadow mask, set for fibres: their visibility is not that of the surface that they lie on.
const MASK_FIBRE: u32 = 0x80000000u;

struct Light {
    position: vec3f,
    kind: u32,
    right: vec3f,
    inner_rad: f32,
    up: vec3f,
    outer_rad: f32,
    axis: vec3f,
    radius: f32,
    color: vec3f,
    // Distance at which the light falls under 1/256 of display white, metres; 0 for a sun, which has none.
    cull_radius_m: f32,
    // Half angles of the beam, radians: inner, outer, and the cutoff of a grid. `has_beam` is 0 if all directions are
    // alike; else 1, and twice the layer of the measured distribution plus one, where there is one.
    beam_rad: vec3f,
    has_beam: u32,
    // Angles of the barn doors from the axis, radians: left, right, top, bottom.
    doors_rad: vec4f,
}

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<storage, read> surfaces: array<Surface>;
@group(0) @binding(2) var<uniform> lights: array<Light, 256>;
// The lights of each screen tile, row by row: one past the last light of each kind, then light indices, four per word.
@group(0) @binding(3) var<uniform> tiles: array<vec4u, TILES_LENGTH>;

// Bounced irradiance at the probes of a grid on surfaces that face +X, -X, +Y, -Y, +Z, -Z: six grids one behind the other
// in z.
@group(0) @binding(4) var bounced_light: texture_3d<f32>;
@group(0) @binding(5) var bounced_light_sampler: sampler;
// Measured intensities relative to their peaks, a layer a table: see `intensity_tables.rs`.
@group(0) @binding(6) var intensity_tables: texture_2d_array<f32>;

const TILE_COLUMNS: u32 = 16u;
const TILE_ROWS: u32 = 9u;
const TILE_STRIDE: u32 = 17u;
const TILES_LENGTH: u32 = TILE_COLUMNS * TILE_ROWS * TILE_STRIDE;

// Packs a direction of any length by the octahedral map, 16 bits per axis (Cigolle et al. 2014).
fn pack_direction(v: vec3f) -> u32 {
    let p = v.xy / (abs(v.x) + abs(v.y) + abs(v.z));
    let sign = select(vec2f(-1.0), vec2f(1.0), p >= vec2f(0.0));
    return pack2x16snorm(select(p, (1.0 - abs(p.yx)) * sign, v.z < 0.0));
}

fn unpack_direction(packed: u32) -> vec3f {
    return normalize(octahedral(packed));
}

// Unpacks a direction without normalising it.
fn octahedral(packed: u32) -> vec3f {
    let p = unpack2x16snorm(packed);
    let z = 1.0 - abs(p.x) - abs(p.y);
    let fold = max(-z, 0.0);
    return vec3f(p - select(vec2f(-fold), vec2f(fold), p >= vec2f(0.0)), z);
}

// Packs a colour as square roots, 10 bits each, which preserves dark albedos, and a surface kind in two bits.
fn pack_color(color: vec3f, kind: u32) -> u32 {
    let q = vec3u(sqrt(saturate(color)) * 1023.0 + 0.5);
    return q.x | (q.y << 10u) | (q.z << 20u) | (kind << 30u);
}

fn unpack_color(packed: u32) -> vec3f {
    let q = vec3f(vec3u(packed, packed >> 10u, packed >> 20u) & vec3u(1023u)) / 1023.0;
    return q * q;
}

// Returns roughness, the square root of the dielectric F0, and metallic; the inverse of `pack_gloss` in `surface.rs`.
fn unpack_gloss(packed: u32) -> vec3f {
    return vec3f(vec3u(packed, packed >> 12u, packed >> 24u) & vec3u(4095u, 4095u, 255u)) / vec3f(4095.0, 4095.0, 255.0);
}

// Packs roughness, the square root of the dielectric F0, and metallic; twin of `pack_gloss` in `surface.rs`.
fn pack_gloss(values: vec3f) -> u32 {
    let q = vec3u(saturate(values) * vec3f(4095.0, 4095.0, 255.0) + 0.5);
    return q.x | (q.y << 12u) | (q.z << 24u);
}

// Packs roughness in 8 bits and metallic in 6 of a surface that glows, and the square root of the part of its emission in 6
// bits a channel; twin of `pack_glowing_gloss` in `surface.rs`. Its dielectric F0 is in its surface record.
fn pack_glowing_gloss(values: vec3f, emission: vec3f) -> u32 {
    let q = vec2u(saturate(values.xz) * vec2f(255.0, 63.0) + 0.5);
    let e = vec3u(sqrt(saturate(emission)) * 63.0 + 0.5);
    return q.x | (q.y << 8u) | (e.x << 14u) | (e.y << 20u) | (e.z << 26u);
}

// Returns roughness, the square root of the dielectric F0, and metallic of a surface that glows, by its index of refraction.
fn unpack_glowing_gloss(packed: u32, ior: f32) -> vec3f {
    let q = vec2f(vec2u(packed, packed >> 8u) & vec2u(255u, 63u)) / vec2f(255.0, 63.0);
    return vec3f(q.x, (ior - 1.0) / (ior + 1.0), q.y);
}

// Returns the part of its emission that a surface gives off at a pixel.
fn unpack_glow(packed: u32) -> vec3f {
    let q = vec3f(vec3u(packed >> 14u, packed >> 20u, packed >> 26u) & vec3u(63u)) / 63.0;
    return q * q;
}

// Returns roughness, the square root of the dielectric F0, and metallic at a pixel of the G-buffer with this id.
fn gloss_at(packed: vec4u, id: u32) -> vec3f {
    if packed.y >> 30u == 1u {
        return unpack_glowing_gloss(packed.w, surfaces[(id & ID_INDEX_MASK) - 1u].ior);
    }
    return unpack_gloss(packed.w);
}

// Packs radiance or irradiance as RGB9E5 (shared exponent): precise to 0.2 % of the largest channel, 2^-24 to 65408.
fn pack_radiance(value: vec3f) -> u32 {
    let color = clamp(value, vec3f(0.0), vec3f(65408.0));
    let largest = max(max(color.x, color.y), max(color.z, 1.5258789e-5));
    // The exponent of the largest channel, plus one where its mantissa rounds up to 512
    let least = i32(bitcast<u32>(largest) >> 23u) - 111;
    let fits = u32(largest * ldexp_24(least) + 0.5) < 512u;
    let exponent = select(least + 1, least, fits);
    let q = vec3u(color * ldexp_24(exponent) + 0.5);
    return q.x | (q.y << 9u) | (q.z << 18u) | (u32(exponent) << 27u);
}

// Returns 2^(24 - exponent), the scale of the mantissas.
fn ldexp_24(exponent: i32) -> f32 {
    return bitcast<f32>(u32(151 - exponent) << 23u);
}

fn unpack_radiance(packed: u32) -> vec3f {
    let q = vec3f(vec3u(packed, packed >> 9u, packed >> 18u) & vec3u(511u));
    return q * bitcast<f32>(((packed >> 27u) + 103u) << 23u);
}

// Returns true if a pixel of the G-buffer shows a fibre, by the kind of surface in its packed colour.
fn is_fibre_color(packed_color: u32) -> bool {
    return packed_color >> 30u == 3u;
}

// Returns the world direction through a pixel position, 1 m long along the optical axis.
fn pixel_ray(pixel: vec2f) -> vec3f {
    let ndc = pixel / frame.size * 2.0 - 1.0;
    return frame.ray_centre + ndc.x * frame.ray_right - ndc.y * frame.ray_up;
}

// Returns the clip position of a corner of a triangle that covers the picture.
fn fullscreen_corner(index: u32) -> vec4f {
    return vec4f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}
