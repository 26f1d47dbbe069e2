// The glass pass: clear glass and water, blended over the lit picture. Reflections are added; refracted environment
// light covers a part of the background. Round bodies refract the environment like a sphere; flat faces do not bend it,
// and their far walls show total internal reflection. Objects behind glass are attenuated but not refracted.

override LINEAR: bool = false;
// Draws the far side of a body, seen through the near one.
override INNER: bool = false;
override HAS_DELTA: bool = true;
override HAS_SPHERES: bool = true;
override HAS_RECTS: bool = true;
override HAS_DISCS: bool = true;
// Reflections show a light at any distance.
const TILED: bool = false;
const LIGHT_CULLING: bool = false;
const HAS_BEAMS: bool = true;

struct VertexOutput {
    @builtin(position) clip: vec4f,
    @location(0) world: vec3f,
    @location(1) normal: vec3f,
}

@vertex
fn vertex(
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
) -> VertexOutput {
    var out: VertexOutput;
    out.world = world_from_object(position);
    out.normal = world_normal(normal);
    out.clip = frame.clip_from_world * vec4f(out.world, 1.0);
    return out;
}

// Coverage of the background by the refracted environment, for round bodies and for flat faces.
const ALPHA_ROUND: f32 = 0.65;
const ALPHA_FLAT: f32 = 0.25;
// Coverage by total internal reflection at a far wall.
const ALPHA_TOTAL: f32 = 0.6;
// Attenuation of the environment behind a flat face and in a far wall, which mostly show the dark beside the set.
const TRANSMITTED_FLAT: f32 = 0.75;
const TRANSMITTED_TOTAL: f32 = 0.5;
// Largest change of the normal between adjacent pixels of a flat face.
const FLAT: f32 = 1e-4;

// Returns the direction of the view ray behind a sphere that it enters at this normal.
fn through_sphere(view: vec3f, normal: vec3f, ior: f32) -> vec3f {
    let inside = refract(-view, normal, 1.0 / ior);
    // Mirror the normal to the exit point of the sphere
    let far = normal - 2.0 * dot(normal, inside) * inside;
    return refract(inside, -far, ior);
}

struct FragmentOutput {
    @location(0) color: vec4f,
    @location(1) id: vec2u,
}

@fragment
fn fragment(in: VertexOutput) -> FragmentOutput {
    let to_eye = frame.eye - in.world;
    let view = normalize(to_eye);
    var geometric_normal = cross(dpdx(in.world), dpdy(in.world));
    geometric_normal *= select(-1.0, 1.0, dot(geometric_normal, to_eye) >= 0.0)
        * inverseSqrt(max(dot(geometric_normal, geometric_normal), 1e-30));
    let squared = dot(in.normal, in.normal);
    var normal = select(geometric_normal, in.normal * inverseSqrt(max(squared, 1e-30)), squared > 1e-20);
    normal *= select(-1.0, 1.0, dot(normal, geometric_normal) >= 0.0);

    let is_flat = dot(fwidth(normal), vec3f(1.0)) < FLAT;
    let s = (draw.surface.z & ID_INDEX_MASK) - 1u;
    let n_dot_v = max(dot(normal, view), 1e-3);
    let frosting = unpack4x8unorm(surfaces[s].layers).w;
    let gloss = vec3f(max(surfaces[s].roughness, frosting), (surfaces[s].ior - 1.0) / (surfaces[s].ior + 1.0), 0.0);
    let coat = shading(in.world, normal, view, vec3f(0.0), gloss);
    let mirror = reflect(-view, normal);
    let fresnel = fresnel(coat.material, n_dot_v);
    var radiance = environment(in.world, mirror, gloss.x) * fresnel;
    if HAS_DELTA {
        radiance += highlights(coat, 0u, frame.light_ends.x, 0u);
    }
    if HAS_SPHERES {
        radiance += highlights(coat, frame.light_ends.x, frame.light_ends.y, 1u);
    }
    if HAS_RECTS {
        radiance += highlights(coat, frame.light_ends.y, frame.light_ends.z, 2u);
    }
    if HAS_DISCS {
        radiance += highlights(coat, frame.light_ends.z, frame.light_ends.w, 3u);
    }
    if INNER {
        let ior = surfaces[s].ior;
        let total = is_flat && ior * ior * (1.0 - n_dot_v * n_dot_v) > 1.0;
        let wall = surfaces[s].base_color * environment(in.world, mirror, 0.0) * TRANSMITTED_TOTAL;
        return covering(wall, select(0.0, ALPHA_TOTAL, total), in.clip.w);
    }
    let rim = pow(1.0 - n_dot_v, 3.0);
    let cover = select(ALPHA_ROUND, ALPHA_FLAT, is_flat);
    // Frosted glass hides what is behind it: the blurred environment takes its place
    let hidden = saturate(1.5 * frosting);
    let alpha = saturate(mix(mix(cover, 1.0, rim), 1.0, hidden) + 1.0 - surfaces[s].transmission);
    let around = environment(in.world, -view, 1.0);
    let beyond = environment(in.world, select(through_sphere(view, normal, surfaces[s].ior), -view, is_flat), frosting);
    // Attenuate at entry and exit
    let body = surfaces[s].base_color * beyond
        * ((1.0 - fresnel) * (1.0 - fresnel) * select(1.0, TRANSMITTED_FLAT, is_flat));
    var out = covering(body, alpha, in.clip.w);
    if LINEAR {
        out.color += vec4f(radiance, 0.0);
    } else {
        // The target holds encoded values: add the difference that the reflection makes over the ambient environment
        out.color += vec4f(srgb_encode(tone_curve(around + radiance)) - srgb_encode(tone_curve(around)), 0.0);
    }
    return out;
}

// Returns a fragment that covers a part of the background, premultiplied.
fn covering(radiance: vec3f, alpha: f32, inverse_distance: f32) -> FragmentOutput {
    var color = radiance;
    if !LINEAR {
        color = srgb_encode(tone_curve(radiance));
    }
    let id = vec2u(draw.surface.z, bitcast<u32>(frame.near_m * inverse_distance));
    return FragmentOutput(vec4f(color * alpha, alpha), id);
}

// Returns the summed highlights of the lights of one kind.
fn highlights(coat: Shading, first: u32, end: u32, kind: u32) -> vec3f {
    var sum = vec3f(0.0);
    for (var light = first; light < end; light++) {
        var a: IncidentLight;
        var value: vec3f;
        if kind == 0u {
            let point = delta_light(light, coat.position);
            value = delta_highlight(coat, point.xyz, lights[light].radius) * point.w;
        } else if kind == 1u {
            let sphere = sphere_light(light, coat.position, coat.normal);
            value = highlight(coat, sphere, true) * sphere.transmission;
        } else {
            a.centre = lights[light].position - coat.position;
            a.right = lights[light].right;
            a.up = lights[light].up;
            let before = dot(a.centre, lights[light].axis) < 0.0;
            value = select(vec3f(0.0), highlight(coat, a, kind == 3u), before);
            if lights[light].has_beam != 0u {
                value *= beam_transmission(light, -normalize(a.centre));
            }
        }
        sum += value * lights[light].color;
    }
    return sum;
}
