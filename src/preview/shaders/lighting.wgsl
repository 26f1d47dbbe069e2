// The lighting pass: every pixel of the G-buffer under every light.

// Whether the picture leaves as scene-linear light or as it is shown.
override LINEAR: bool = false;

@group(1) @binding(0) var gbuffer: texture_2d<u32>;
@group(1) @binding(1) var ids: texture_2d<u32>;

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return fullscreen_corner(index);
}

fn shown(radiance: vec3f) -> vec4f {
    if LINEAR {
        return vec4f(radiance, 1.0);
    }
    return vec4f(srgb_encode(tone_curve(radiance)), 1.0);
}

@fragment
fn fragment(@builtin(position) at: vec4f) -> @location(0) vec4f {
    let pixel = vec2i(at.xy);
    let id = textureLoad(ids, pixel, 0).xy;
    if id.x == 0u {
        return shown(frame.void_radiance);
    }
    let packed = textureLoad(gbuffer, pixel, 0);
    let kind = packed.y >> 30u;
    if kind == 2u {
        return shown(surfaces[id.x - 1u].emission);
    }
    let ray = pixel_ray(at.xy);
    let position = frame.eye + ray * (frame.near_m / bitcast<f32>(id.y));
    let view = -normalize(ray);
    let face = unpack_direction(packed.z);
    let normal = unpack_direction(packed.x);
    let gloss = unpack_gloss(packed.w);
    let n_dot_v = max(dot(normal, view), 1e-3);
    let surface = material(unpack_color(packed.y), gloss, n_dot_v);
    let mirror = reflect(-view, normal);

    var radiance = surface.diffuse * frame.ambient / PI;
    let ab = albedo_scale_bias(n_dot_v, gloss.x);
    radiance += environment(position, mirror, gloss.x) * saturate(surface.f0 * ab.x + ab.y) * surface.boost;
    if kind == 1u {
        radiance += surfaces[id.x - 1u].emission;
    }
    for (var light = 0u; light < frame.light_count; light++) {
        let a = arrival(light, position, normal, mirror);
        if a.irradiance <= 0.0 {
            continue;
        }
        let reflected = surface.diffuse * (a.irradiance / PI) + highlight(surface, a, normal, view, n_dot_v);
        radiance += reflected * lights[light].color * visibility(light, position, face, at.xy);
    }
    return shown(radiance);
}
