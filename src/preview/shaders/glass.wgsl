// Clear glass and water over the lit picture: what mirrors in it is added, its rim darkens what lies behind. Nothing is
// refracted; the outline and the highlights tell the shape.

override LINEAR: bool = false;
override HAS_DELTA: bool = true;
override HAS_SPHERES: bool = true;
override HAS_RECTS: bool = true;
override HAS_DISCS: bool = true;
// Mirrors show a light however far it is.
const LISTED: bool = false;
const REACH: bool = false;
const HAS_BEAMS: bool = true;

struct Corner {
    @builtin(position) clip: vec4f,
    @location(0) world: vec3f,
    @location(1) normal: vec3f,
}

@vertex
fn vertex(
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
) -> Corner {
    var out: Corner;
    out.world = world_from_object(position);
    out.normal = world_normal(normal);
    out.clip = frame.clip_from_world * vec4f(out.world, 1.0);
    return out;
}

struct Pixel {
    @location(0) color: vec4f,
    @location(1) id: vec2u,
}

@fragment
fn fragment(in: Corner) -> Pixel {
    let to_eye = frame.eye - in.world;
    let view = normalize(to_eye);
    var face = cross(dpdx(in.world), dpdy(in.world));
    face *= select(-1.0, 1.0, dot(face, to_eye) >= 0.0) * inverseSqrt(max(dot(face, face), 1e-30));
    let squared = dot(in.normal, in.normal);
    var normal = select(face, in.normal * inverseSqrt(max(squared, 1e-30)), squared > 1e-20);
    normal *= select(-1.0, 1.0, dot(normal, face) >= 0.0);

    let s = (draw.surface.z & MARK_NUMBER) - 1u;
    let n_dot_v = max(dot(normal, view), 1e-3);
    let gloss = vec3f(surfaces[s].roughness, (surfaces[s].ior - 1.0) / (surfaces[s].ior + 1.0), 0.0);
    let coat = shading(in.world, normal, view, vec3f(0.0), gloss);
    let mirror = reflect(-view, normal);
    let fresnel = fresnel(coat.material, n_dot_v);
    var radiance = environment(in.world, mirror, gloss.x) * fresnel;
    if HAS_DELTA {
        radiance += glints(coat, 0u, frame.light_ends.x, 0u);
    }
    if HAS_SPHERES {
        radiance += glints(coat, frame.light_ends.x, frame.light_ends.y, 1u);
    }
    if HAS_RECTS {
        radiance += glints(coat, frame.light_ends.y, frame.light_ends.z, 2u);
    }
    if HAS_DISCS {
        radiance += glints(coat, frame.light_ends.z, frame.light_ends.w, 3u);
    }
    // Glass bends light most at its rim, where it gathers what is dark around it.
    let rim = pow(1.0 - n_dot_v, 3.0);
    let alpha = saturate(0.08 + 0.4 * rim + 1.0 - surfaces[s].transmission);
    let around = frame.ambient / PI + environment(in.world, -view, 1.0);
    let body = surfaces[s].base_color * around * 0.4;
    var out: Pixel;
    if LINEAR {
        out.color = vec4f(radiance + body * alpha, alpha);
    } else {
        // The target holds encoded values: add as much as the light would add to what is likely behind.
        let added = srgb_encode(tone_curve(around + radiance)) - srgb_encode(tone_curve(around));
        out.color = vec4f(added + srgb_encode(tone_curve(body)) * alpha, alpha);
    }
    out.id = vec2u(draw.surface.z, bitcast<u32>(frame.near_m * in.clip.w));
    return out;
}

// Highlights of a family of lights.
fn glints(coat: Shading, first: u32, end: u32, family: u32) -> vec3f {
    var sum = vec3f(0.0);
    for (var light = first; light < end; light++) {
        var a: Arrival;
        var value: vec3f;
        if family == 0u {
            let point = delta_arrival(light, coat.position);
            value = glint(coat, point.xyz, lights[light].radius) * point.w;
        } else if family == 1u {
            let ball = sphere_arrival(light, coat.position, coat.normal);
            value = highlight(coat, ball, true) * ball.passed;
        } else {
            a.centre = lights[light].position - coat.position;
            a.right = lights[light].right;
            a.up = lights[light].up;
            let before = dot(a.centre, lights[light].axis) < 0.0;
            value = select(vec3f(0.0), highlight(coat, a, family == 3u), before);
            if lights[light].has_beam != 0u {
                value *= passed(light, -normalize(a.centre));
            }
        }
        sum += value * lights[light].color;
    }
    return sum;
}
