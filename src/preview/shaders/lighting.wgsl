// The lighting pass: shades the G-buffer with the lights of each pixel's tile.
//
// `fragment` shades each pixel. `coarse_fragment` shades one pixel of each coarse pixel, which `resolve.wgsl`
// upsamples: the draft of CPU rasterisers while something moves.

// Writes scene-linear radiance instead of display values.
override LINEAR: bool = false;
// The kinds of lights that are present; code for the others is compiled out.
override HAS_DELTA: bool = true;
override HAS_SPHERES: bool = true;
override HAS_RECTS: bool = true;
override HAS_DISCS: bool = true;
// Layers of the shadow mask in use, four lights each; 0 without shadows.
override MASKS: u32 = 0;
// Picture pixels per mask pixel along each axis.
override MASK_SCALE: u32 = 1;
// Reads the list of lights of each screen tile instead of all lights.
override TILED: bool = false;
// Skips a light beyond its radius, where it falls under 1/256 of display white.
override LIGHT_CULLING: bool = true;
// A modifier narrows the beam of at least one light.
override HAS_BEAMS: bool = true;
// Writes the irradiance, as reflected by a white Lambertian surface.
override ILLUMINANCE: bool = false;
// Strands are present.
override HAS_FIBRES: bool = false;
// Surfaces with lacquer or translucency are present.
override HAS_LAYERS: bool = false;
// Surfaces with normal maps are present.
override HAS_RELIEF: bool = false;
// Uses Blinn-Phong highlights instead of GGX.
override BLINN_PHONG: bool = false;

@group(1) @binding(0) var gbuffer: texture_2d<u32>;
@group(1) @binding(1) var ids: texture_2d<u32>;
@group(2) @binding(0) var masks: texture_2d_array<u32>;

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return fullscreen_corner(index);
}

// Visibility of each shadowed light at the pixel.
var<private> visibilities: array<vec4f, 4>;

// Outgoing radiance of a pixel: diffuse for unit base colour, and everything else.
struct ShadedLight {
    diffuse: vec3f,
    specular: vec3f,
}

// Returns the highlight of an emitter with a size; none for an emitter below the horizon.
fn emitter_highlight(s: Shading, a: IncidentLight, round: bool) -> vec3f {
    if ILLUMINANCE {
        return vec3f(0.0);
    }
    if BLINN_PHONG {
        return blinn_phong(s, a.centre) * a.irradiance;
    }
    return select(vec3f(0.0), highlight(s, a, round), a.irradiance > 0.0);
}

// Returns the relative transmission of the coat; 1 in the illuminance channel.
fn coat_factor(s: Shading, cosine: f32, hemisphere_fraction: f32) -> f32 {
    if ILLUMINANCE {
        return 1.0;
    }
    return coat_transmission(s.material, cosine, hemisphere_fraction);
}

// Returns the visibility of four lights at a pixel. Masks at reduced resolution are upsampled bilaterally: bilinear
// weights, restricted to mask pixels on the pixel's plane. `depth` is negative for fibres, as in the mask.
fn mask_visibility(mask: u32, at: vec2f, depth: f32, geometric_normal: vec3f) -> vec4f {
    if MASK_SCALE == 1u {
        return unpack4x8unorm(textureLoad(masks, vec2i(at), mask, 0).x);
    }
    let last = vec2i(textureDimensions(masks)) - 1;
    let mask_uv = floor(at) / f32(MASK_SCALE);
    let corner = vec2i(mask_uv);
    let part = fract(mask_uv);
    let here = dot(geometric_normal, pixel_ray(at));
    let scale = depth / select(here, 1e-6, abs(here) < 1e-6);
    var sum = vec4f(0.0);
    var total = 0.0;
    for (var i = 0; i < 4; i++) {
        let step = vec2i(i & 1, i >> 1);
        let texel_at = min(corner + step, last);
        let texel = textureLoad(masks, texel_at, mask, 0).xy;
        let expected = dot(geometric_normal, pixel_ray(vec2f(texel_at * i32(MASK_SCALE)) + 0.5)) * scale;
        let on_plane = abs(bitcast<f32>(texel.y) - expected) <= 0.01 * abs(expected);
        let across = mix(1.0 - part, part, vec2f(step));
        let weight = (across.x * across.y + 1e-3) * select(1e-3, 1.0, on_plane);
        sum += unpack4x8unorm(texel.x) * weight;
        total += weight;
    }
    return sum / total;
}

// Returns the visibility of a light: four lights per mask, lights beyond the masks are unshadowed.
fn light_visibility(light: u32) -> f32 {
    if MASKS == 0u {
        return 1.0;
    }
    if MASKS == 1u {
        return select(1.0, visibilities[0][light & 3u], light < 4u);
    }
    return select(1.0, visibilities[(light >> 2u) & 3u][light & 3u], light < 4u * MASKS);
}

// The G-buffer and id buffer at a pixel, and its position.
struct GBufferSample {
    packed: vec4u,
    id: vec2u,
    at: vec2f,
}

fn sample_at(pixel: vec2u) -> GBufferSample {
    return GBufferSample(textureLoad(gbuffer, pixel, 0), textureLoad(ids, pixel, 0).xy, vec2f(pixel) + 0.5);
}

fn load_visibility(p: GBufferSample) {
    let geometric_normal = unpack_direction(p.packed.z);
    let depth = max(bitcast<f32>(p.id.y), 1e-9);
    let mask_depth = select(depth, -depth, is_fibre_color(p.packed.y));
    for (var mask = 0u; mask < MASKS; mask++) {
        visibilities[mask] = mask_visibility(mask, p.at, mask_depth, geometric_normal);
    }
}

// Returns the light that a fibre scatters from a light; nothing for other surfaces. `from_light` is the colour times
// normal irradiance, without visibility; `a` has the light's centre and half axes.
fn fibre_light(f: Fibre, is_fibre: bool, light: u32, from_light: vec3f, direction: vec3f, angle2: f32) -> vec3f {
    var sum = vec3f(0.0);
    // A loop, for CPU rasterisers execute both sides of a branch
    for (var i = 0u; i < select(0u, 1u, is_fibre); i++) {
        sum = hair_scatter(f, direction, angle2) * scattered_visibility(f, light_visibility(light)) * from_light;
    }
    return sum;
}

// Returns the squared angular radius of an emitter.
fn emitter_angle2(a: IncidentLight) -> f32 {
    return max(dot(a.right, a.right), dot(a.up, a.up)) / max(dot(a.centre, a.centre), 1e-6);
}

// Bends a normal towards the geometric normal until the view is mirrored above the surface; twin of `math::bend_above`.
fn bend_above(normal: vec3f, geometric_normal: vec3f, view_dir: vec3f) -> vec3f {
    let c = max(dot(view_dir, geometric_normal), 1e-6);
    let a = dot(view_dir, normal);
    let d = dot(normal, geometric_normal);
    let root = sqrt(max(a * a + c * (c - 2.0 * a * d), 0.0));
    let s = select((root - a) / c, (c - 2.0 * a * d) / max(a + root, 1e-12), a > 0.0);
    let bent = normalize(normalize(normal + geometric_normal * s) + geometric_normal * 1e-3);
    return select(bent, normal, a > 0.0 && 2.0 * a * d >= c);
}

// Returns the normal that a light is received with: towards the light for a fibre.
fn receiving_normal(s: Shading, normal: vec3f, is_fibre: bool, light: u32) -> vec3f {
    if !HAS_FIBRES {
        return normal;
    }
    let to_light = lights[light].position - s.position;
    return select(normal, to_light * inverseSqrt(max(dot(to_light, to_light), 1e-12)), is_fibre);
}

// Square root of the F0 of lacquer, of index 1.5.
const LACQUER_SQRT_F0: f32 = 0.2;

// Shades a pixel. The loops test at their end: there is at least one light of each kind, and a CPU rasteriser would pay
// for the extra iteration that a test at the start costs.
fn shade(p: GBufferSample) -> ShadedLight {
    // Reconstruct the shading point from the G-buffer
    let depth = max(bitcast<f32>(p.id.y), 1e-9);
    let ray = pixel_ray(p.at);
    let gloss = gloss_at(p.packed, p.id.x);
    let position = frame.eye + ray * (frame.near_m / depth);
    // What a normal map leans away from the view mirrors nothing: bend the normal of reflections, and keep that of diffuse
    // light
    let normal = unpack_direction(p.packed.x);
    var mirror_normal = normal;
    if HAS_RELIEF {
        let flags = surfaces[max(p.id.x & ID_INDEX_MASK, 1u) - 1u].flags;
        // A smooth gloss has its normal in place of the geometric one
        let surface_normal = unpack_direction(p.packed.z);
        let bent = bend_above(normal, surface_normal, -normalize(ray));
        let mirror = select(bent, surface_normal, (flags & FLAG_SMOOTH_GLOSS) != 0u);
        mirror_normal = select(normal, mirror, p.id.x != 0u && (flags & FLAG_RELIEF) != 0u);
    }
    let s = shading(position, mirror_normal, -normalize(ray), unpack_color(p.packed.y), gloss);
    // Ambient and environment light
    var diffuse = ambient(position, normal);
    if ILLUMINANCE {
        diffuse = vec3f(0.0);
    }
    var specular = environment(position, reflect(-s.view, s.normal), gloss.x) * s.material.reflectance;

    // Lacquer reflects and lets the rest through; a translucent sheet is lit from its far side, too, where shadows are
    // left out
    var layers = vec4f(0.0);
    var lacquer: Shading;
    var lacquer_light = vec3f(0.0);
    var far_side = vec3f(0.0);
    if HAS_LAYERS {
        layers = unpack4x8unorm(surfaces[max(p.id.x & ID_INDEX_MASK, 1u) - 1u].layers) * select(1.0, 0.0, p.id.x == 0u);
        lacquer = shading(position, s.normal, s.view, vec3f(0.0), vec3f(layers.y, LACQUER_SQRT_F0, 0.0));
        lacquer_light = environment(position, reflect(-s.view, s.normal), layers.y) * lacquer.material.reflectance;
        far_side = ambient(position, -normal);
    }

    // Fibres have their tangent in place of the normal, and scatter light over the whole sphere
    let is_fibre = HAS_FIBRES && is_fibre_color(p.packed.y);
    var f: Fibre;
    var scattered = vec3f(0.0);
    if HAS_FIBRES {
        for (var i = 0u; i < select(0u, 1u, is_fibre); i++) {
            f = fibre(s.normal, s.view, surfaces[(p.id.x & ID_INDEX_MASK) - 1u]);
            // Behind a fibre there is the head or more hair
            let behind = ambient(position, -f.facing) * f.passed;
            scattered = f.albedo * (0.5 / PI) * (ambient(position, f.facing) + behind);
        }
    }

    let tile = tile_offset(p.at);
    // Points, spots and suns
    if HAS_DELTA {
        var k = 0u;
        loop {
            let light = tile_light(tile, k);
            let a = delta_light(light, position);
            let color = lights[light].color * (a.w * light_visibility(light) * present(k, deltas_end(tile)));
            if HAS_FIBRES {
                let angle2 = lights[light].radius * lights[light].radius;
                let from_light = lights[light].color * (a.w * present(k, deltas_end(tile)));
                scattered += fibre_light(f, is_fibre, light, from_light, a.xyz, angle2);
            }
            let cosine = max(dot(normal, a.xyz), 0.0);
            diffuse += color * (cosine * coat_factor(s, cosine, 0.0));
            if BLINN_PHONG {
                specular += blinn_phong(s, a.xyz) * max(dot(s.normal, a.xyz), 0.0) * color;
            } else {
                specular += delta_highlight(s, a.xyz, lights[light].radius) * color;
            }
            if HAS_LAYERS {
                lacquer_light += delta_highlight(lacquer, a.xyz, lights[light].radius) * color;
                far_side += lights[light].color
                    * (a.w * present(k, deltas_end(tile)) * max(-dot(normal, a.xyz), 0.0));
            }
            k++;
            continuing {
                break if k >= deltas_end(tile);
            }
        }
    }
    // Spheres
    if HAS_SPHERES {
        var k = deltas_end(tile);
        loop {
            let light = tile_light(tile, k);
            let a = sphere_light(light, position, receiving_normal(s, normal, is_fibre, light));
            if HAS_FIBRES {
                let from_light = lights[light].color
                    * (present(k, spheres_end(tile)) * radius_window(light, a.centre) * a.transmission * a.irradiance);
                let direction = a.centre * inverseSqrt(max(dot(a.centre, a.centre), 1e-12));
                scattered += fibre_light(f, is_fibre, light, from_light, direction, emitter_angle2(a));
            }
            let color = lights[light].color
                * (light_visibility(light) * present(k, spheres_end(tile)) * radius_window(light, a.centre) * a.transmission);
            diffuse += color * (a.irradiance * coat_factor(s, a.cosine, a.irradiance / PI));
            specular += color * emitter_highlight(s, a, true);
            if HAS_LAYERS {
                lacquer_light += color * emitter_highlight(lacquer, a, true);
                let far = sphere_light(light, position, -normal);
                far_side += lights[light].color
                    * (present(k, spheres_end(tile)) * radius_window(light, a.centre) * far.transmission * far.irradiance);
            }
            k++;
            continuing {
                break if k >= spheres_end(tile);
            }
        }
    }
    // Rectangular panels
    if HAS_RECTS {
        var k = spheres_end(tile);
        loop {
            let light = tile_light(tile, k);
            let a = panel_light(light, position, receiving_normal(s, normal, is_fibre, light), false);
            if HAS_FIBRES {
                let from_light = lights[light].color
                    * (present(k, rects_end(tile)) * panel_radius_window(light, a.centre) * a.transmission * a.irradiance);
                let direction = a.centre * inverseSqrt(max(dot(a.centre, a.centre), 1e-12));
                scattered += fibre_light(f, is_fibre, light, from_light, direction, emitter_angle2(a));
            }
            let color = lights[light].color
                * (light_visibility(light) * present(k, rects_end(tile)) * panel_radius_window(light, a.centre) * a.transmission);
            diffuse += color * (a.irradiance * coat_factor(s, a.cosine, a.irradiance / PI));
            specular += color * emitter_highlight(s, a, false);
            if HAS_LAYERS {
                lacquer_light += color * emitter_highlight(lacquer, a, false);
                let far = panel_light(light, position, -normal, false);
                far_side += lights[light].color
                    * (present(k, rects_end(tile)) * panel_radius_window(light, a.centre) * far.transmission * far.irradiance);
            }
            k++;
            continuing {
                break if k >= rects_end(tile);
            }
        }
    }
    // Discs
    if HAS_DISCS {
        var k = rects_end(tile);
        loop {
            let light = tile_light(tile, k);
            let a = panel_light(light, position, receiving_normal(s, normal, is_fibre, light), true);
            if HAS_FIBRES {
                let from_light = lights[light].color
                    * (present(k, discs_end(tile)) * panel_radius_window(light, a.centre) * a.transmission * a.irradiance);
                let direction = a.centre * inverseSqrt(max(dot(a.centre, a.centre), 1e-12));
                scattered += fibre_light(f, is_fibre, light, from_light, direction, emitter_angle2(a));
            }
            let color = lights[light].color
                * (light_visibility(light) * present(k, discs_end(tile)) * panel_radius_window(light, a.centre) * a.transmission);
            diffuse += color * (a.irradiance * coat_factor(s, a.cosine, a.irradiance / PI));
            specular += color * emitter_highlight(s, a, true);
            if HAS_LAYERS {
                lacquer_light += color * emitter_highlight(lacquer, a, true);
                let far = panel_light(light, position, -normal, true);
                far_side += lights[light].color
                    * (present(k, discs_end(tile)) * panel_radius_window(light, a.centre) * far.transmission * far.irradiance);
            }
            k++;
            continuing {
                break if k >= discs_end(tile);
            }
        }
    }
    if ILLUMINANCE {
        return ShadedLight(diffuse / PI, vec3f(0.0));
    }
    if HAS_LAYERS {
        let past = 1.0 - layers.x * lacquer.material.reflectance.x;
        diffuse = mix(diffuse, far_side, layers.z) * past;
        specular = specular * past + lacquer_light * layers.x;
    }
    diffuse *= s.material.diffuse / PI;
    // Add emission. Surface kinds: 1 lit and emissive, 2 the front of an emitter
    let kind = p.packed.y >> 30u;
    if HAS_FIBRES && is_fibre {
        diffuse = vec3f(0.0);
        specular = scattered;
    }
    if kind != 0u {
        let glow = select(vec3f(1.0), unpack_glow(p.packed.w), kind == 1u);
        let emission = surfaces[(p.id.x & ID_INDEX_MASK) - 1u].emission * glow;
        specular = select(specular, vec3f(0.0), kind == 2u) + emission;
    }
    specular = select(specular, frame.void_radiance, p.id.x == 0u);
    return ShadedLight(diffuse, specular);
}

@fragment
fn fragment(@builtin(position) at: vec4f) -> @location(0) vec4f {
    let p = sample_at(vec2u(at.xy));
    load_visibility(p);
    let out = shade(p);
    if ILLUMINANCE {
        let white = select(out.diffuse, vec3f(0.0), p.id.x == 0u);
        if LINEAR {
            return vec4f(white, 1.0);
        }
        return false_color(white);
    }
    let radiance = select(unpack_color(p.packed.y), vec3f(0.0), p.id.x == 0u) * out.diffuse + out.specular;
    if LINEAR {
        return vec4f(radiance, 1.0);
    }
    return encode_display(radiance, at.xy);
}

// Shades one pixel of a coarse pixel: diffuse and specular light, normal, depth.
@fragment
fn coarse_fragment(@builtin(position) at: vec4f) -> @location(0) vec4u {
    let p = sample_at(min(vec2u(at.xy) * frame.coarse_scale, vec2u(frame.size) - 1u));
    load_visibility(p);
    let out = shade(p);
    return vec4u(pack_radiance(out.diffuse), pack_radiance(out.specular), p.packed.x, p.id.y);
}
