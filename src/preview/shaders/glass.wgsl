// Clear glass and water over the lit picture: what mirrors in it is added, and what shines through it covers a part of
// what lies behind. Round bodies bend the view as a ball does and show the surroundings upside down; flat faces leave it
// straight, and behind them walls that are met too flatly reflect everything. Other things are not seen bent, only weaker.

override LINEAR: bool = false;
// Whether it is the far side of a body that is drawn, as it is seen through the near one.
override INNER: bool = false;
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

// How much of what lies behind a round body is covered by what it shows instead, and a flat face.
const COVERED_ROUND: f32 = 0.65;
const COVERED_FLAT: f32 = 0.25;
// The same of a far wall that reflects everything.
const COVERED_TOTAL: f32 = 0.6;
// Part that is left of it behind a flat face and in a far wall: much of what these show is the dark beside the set.
const LEFT_FLAT: f32 = 0.75;
const LEFT_TOTAL: f32 = 0.5;
// Change of the normal from one pixel to the next under which a face is flat.
const FLAT: f32 = 1e-4;

// Where a view goes on behind a ball that it meets under this normal.
fn through_ball(view: vec3f, normal: vec3f, ior: f32) -> vec3f {
    let inside = refract(-view, normal, 1.0 / ior);
    // The ball's normal where the view leaves it.
    let far = normal - 2.0 * dot(normal, inside) * inside;
    return refract(inside, -far, ior);
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

    let is_flat = dot(fwidth(normal), vec3f(1.0)) < FLAT;
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
    if INNER {
        let ior = surfaces[s].ior;
        let total = is_flat && ior * ior * (1.0 - n_dot_v * n_dot_v) > 1.0;
        let wall = surfaces[s].base_color * environment(in.world, mirror, 0.0) * LEFT_TOTAL;
        return covering(wall, select(0.0, COVERED_TOTAL, total), in.clip.w);
    }
    let rim = pow(1.0 - n_dot_v, 3.0);
    let cover = select(COVERED_ROUND, COVERED_FLAT, is_flat);
    let alpha = saturate(mix(cover, 1.0, rim) + 1.0 - surfaces[s].transmission);
    let around = environment(in.world, -view, 1.0);
    let beyond = environment(in.world, select(through_ball(view, normal, surfaces[s].ior), -view, is_flat), 0.0);
    // Two surfaces take their part.
    let body = surfaces[s].base_color * beyond * ((1.0 - fresnel) * (1.0 - fresnel) * select(1.0, LEFT_FLAT, is_flat));
    var out = covering(body, alpha, in.clip.w);
    if LINEAR {
        out.color += vec4f(radiance, 0.0);
    } else {
        // The target holds encoded values: add as much as the light would add to what is likely behind.
        out.color += vec4f(srgb_encode(tone_curve(around + radiance)) - srgb_encode(tone_curve(around)), 0.0);
    }
    return out;
}

// Something that covers a part of what lies behind.
fn covering(radiance: vec3f, alpha: f32, inverse_distance: f32) -> Pixel {
    var shown = radiance;
    if !LINEAR {
        shown = srgb_encode(tone_curve(radiance));
    }
    return Pixel(vec4f(shown * alpha, alpha), vec2u(draw.surface.z, bitcast<u32>(frame.near_m * inverse_distance)));
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
