// Each emitter's light on a surface: exact diffuse irradiance, and a highlight at the emitter's most telling point.

const KIND_POINT: u32 = 0u;
const KIND_SPOT: u32 = 1u;
const KIND_SPHERE: u32 = 2u;
const KIND_RECT: u32 = 3u;
const KIND_DISC: u32 = 4u;
const KIND_SUN: u32 = 5u;
// Corners of the polygon that stands for a disc, of the same area.
const DISC_CORNERS: u32 = 12u;

// Falls linearly in angle from the inner to the outer half angle; a step where they are equal.
fn spot_falloff(cosine: f32, inner_rad: f32, outer_rad: f32) -> f32 {
    let angle = acos(clamp(cosine, -1.0, 1.0));
    return select(saturate((outer_rad - angle) / max(outer_rad - inner_rad, 1e-6)), 1.0, angle <= inner_rad);
}

// Angle between two corners as seen from the receiver, times the cosine between their plane's normal and the
// receiver's: one edge's part of Lambert's formula.
fn edge_part(a: vec3f, b: vec3f, normal: vec3f) -> f32 {
    let c = cross(a, b);
    let sine = length(c);
    return dot(c, normal) * atan2(sine, dot(a, b)) / max(sine, 1e-20);
}

// A polygon edge by edge, clipped at the receiver's horizon without a list of corners: a convex polygon leaves and
// enters the upper half once, and the edge between those two points closes it.
struct Outline {
    sum: f32,
    leaves: vec3f,
    enters: vec3f,
    clipped: bool,
}

fn add_edge(o: ptr<function, Outline>, a: vec3f, b: vec3f, normal: vec3f) {
    let height_a = dot(a, normal);
    let height_b = dot(b, normal);
    if height_a <= 0.0 && height_b <= 0.0 {
        return;
    }
    var from_corner = a;
    var to_corner = b;
    if height_a < 0.0 {
        from_corner = mix(a, b, height_a / (height_a - height_b));
        (*o).enters = from_corner;
        (*o).clipped = true;
    }
    if height_b < 0.0 {
        to_corner = mix(a, b, height_a / (height_a - height_b));
        (*o).leaves = to_corner;
        (*o).clipped = true;
    }
    (*o).sum += edge_part(from_corner, to_corner, normal);
}

// Solid angle weighted by the cosine at the receiver, which is irradiance for unit luminance.
fn outline_irradiance(o: Outline, normal: vec3f) -> f32 {
    var sum = o.sum;
    if o.clipped {
        sum += edge_part(o.leaves, o.enters, normal);
    }
    return 0.5 * abs(sum);
}

fn rect_irradiance(centre: vec3f, right: vec3f, up: vec3f, normal: vec3f) -> f32 {
    let a = centre - right - up;
    let b = centre + right - up;
    let c = centre + right + up;
    let d = centre - right + up;
    var o: Outline;
    add_edge(&o, a, b, normal);
    add_edge(&o, b, c, normal);
    add_edge(&o, c, d, normal);
    add_edge(&o, d, a, normal);
    return outline_irradiance(o, normal);
}

fn disc_irradiance(centre: vec3f, right: vec3f, up: vec3f, normal: vec3f) -> f32 {
    let step = 2.0 * PI / f32(DISC_CORNERS);
    let grow = sqrt(step / sin(step));
    let turn = vec2f(cos(step), sin(step));
    var at = vec2f(grow, 0.0);
    var from_corner = centre + at.x * right;
    var o: Outline;
    for (var i = 0u; i < DISC_CORNERS; i++) {
        at = vec2f(at.x * turn.x - at.y * turn.y, at.x * turn.y + at.y * turn.x);
        let to_corner = centre + at.x * right + at.y * up;
        add_edge(&o, from_corner, to_corner, normal);
        from_corner = to_corner;
    }
    return outline_irradiance(o, normal);
}

// Irradiance of a sphere of unit luminance, cut by the horizon (Snyder 1996, area light sources for real-time graphics).
fn sphere_irradiance(cosine: f32, distance: f32, radius: f32) -> f32 {
    let sine = min(radius / distance, 0.9999);
    let squared = sine * sine;
    if cosine >= sine {
        return PI * squared * cosine;
    }
    if cosine <= -sine {
        return 0.0;
    }
    let across = sqrt(max(1.0 - cosine * cosine, 1e-12));
    let tangent = sqrt(1.0 - squared) / sine;
    let inside = clamp(-cosine / across * tangent, -1.0, 1.0);
    let edge = sqrt(max(squared - cosine * cosine, 0.0)) * sqrt(1.0 - squared);
    return max(squared * cosine * acos(inside) - edge + atan2(sqrt(max(squared - cosine * cosine, 0.0)), sqrt(1.0 - squared)), 0.0);
}

// What a light does at a point, before shadow.
struct Arrival {
    // Irradiance, as a factor of the light's colour.
    irradiance: f32,
    // Solid angle of the emitter and normal illuminance for the highlight, as a factor of the colour.
    solid_angle: f32,
    perpendicular: f32,
    // Where the highlight comes from, unit.
    direction: vec3f,
}

// Most telling direction of a ball: the one nearest to the mirror direction (Karis 2013).
fn toward_ball(to_centre: vec3f, radius: f32, mirror: vec3f) -> vec3f {
    let off = dot(to_centre, mirror) * mirror - to_centre;
    return normalize(to_centre + off * saturate(radius * inverseSqrt(max(dot(off, off), 1e-20))));
}

fn arrival(light: u32, position: vec3f, normal: vec3f, mirror: vec3f) -> Arrival {
    var out: Arrival;
    let kind = lights[light].kind;
    if kind == KIND_SUN {
        let radius = lights[light].radius;
        let to_sun = -lights[light].axis;
        out.irradiance = max(dot(normal, to_sun), 0.0);
        out.perpendicular = 1.0;
        out.solid_angle = PI * radius * radius;
        out.direction = toward_ball(to_sun, radius, mirror);
        return out;
    }
    let to_light = lights[light].position - position;
    let squared = max(dot(to_light, to_light), 1e-12);
    let distance = sqrt(squared);
    let direction = to_light / distance;
    if kind <= KIND_SPOT {
        var intensity = 1.0 / squared;
        if kind == KIND_SPOT {
            let cosine = -dot(direction, lights[light].axis);
            intensity *= spot_falloff(cosine, lights[light].inner_rad, lights[light].outer_rad);
        }
        out.irradiance = max(dot(normal, direction), 0.0) * intensity;
        out.perpendicular = intensity;
        out.direction = direction;
        return out;
    }
    if kind == KIND_SPHERE {
        let radius = lights[light].radius;
        out.irradiance = sphere_irradiance(dot(normal, direction), distance, radius);
        let sine = min(radius / distance, 1.0);
        out.solid_angle = 2.0 * PI * (1.0 - sqrt(1.0 - sine * sine));
        out.perpendicular = out.solid_angle;
        out.direction = toward_ball(to_light, radius, mirror);
        return out;
    }
    let axis = lights[light].axis;
    let height = -dot(to_light, axis);
    if height <= 0.0 {
        return out;
    }
    let right = lights[light].right;
    let up = lights[light].up;
    // The mirror ray's hit on the panel's plane, moved into the panel; a ray that runs away from it counts as far off.
    let towards = max(-dot(mirror, axis), 1e-3);
    let hit = mirror * (height / towards) - to_light;
    var local = vec2f(dot(hit, right) / dot(right, right), dot(hit, up) / dot(up, up));
    if kind == KIND_RECT {
        out.irradiance = rect_irradiance(to_light, right, up, normal);
        local = clamp(local, vec2f(-1.0), vec2f(1.0));
    } else {
        out.irradiance = disc_irradiance(to_light, right, up, normal);
        local *= inverseSqrt(max(dot(local, local), 1.0));
    }
    let telling = to_light + local.x * right + local.y * up;
    let reach = dot(telling, telling);
    out.direction = telling * inverseSqrt(reach);
    let facing = height * inverseSqrt(reach);
    let flat_angle = lights[light].area_m2 * facing / reach;
    out.solid_angle = flat_angle / (1.0 + flat_angle / (2.0 * PI));
    out.perpendicular = out.solid_angle;
    return out;
}
