// Each emitter's light on a surface: exact diffuse irradiance, and a highlight at the emitter's most telling point.

const KIND_POINT: u32 = 0u;
const KIND_SPOT: u32 = 1u;
const KIND_SPHERE: u32 = 2u;
const KIND_RECT: u32 = 3u;
const KIND_DISC: u32 = 4u;
const KIND_SUN: u32 = 5u;
// Corners of the polygon that stands for a disc, of the same area. Six come within 0.2 % on its axis, however near.
const DISC_CORNERS: u32 = 6u;

// Falls linearly in angle from the inner to the outer half angle; a step where they are equal.
fn spot_falloff(cosine: f32, inner_rad: f32, outer_rad: f32) -> f32 {
    let angle = acos(clamp(cosine, -1.0, 1.0));
    return select(saturate((outer_rad - angle) / max(outer_rad - inner_rad, 1e-6)), 1.0, angle <= inner_rad);
}

// Arc cosine over sine of an angle with this cosine, to 7e-5 (after Abramowitz and Stegun 4.4.45).
fn angle_over_sine(cosine: f32) -> f32 {
    let x = abs(cosine);
    let near = (((-0.0187293 * x + 0.0742610) * x - 0.2121144) * x + 1.5707288) * inverseSqrt(1.0 + x);
    let far = PI * inverseSqrt(max(1.0 - x * x, 1e-12)) - near;
    return select(far, near, cosine >= 0.0);
}

// Angle between two corners as seen from the receiver, times the cosine between their plane's normal and the
// receiver's: one edge's part of Lambert's formula.
fn edge_part(a: vec3f, b: vec3f, normal: vec3f) -> f32 {
    let scale = inverseSqrt(max(dot(a, a) * dot(b, b), 1e-30));
    return dot(cross(a, b), normal) * scale * angle_over_sine(dot(a, b) * scale);
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
    // Where the edge crosses the horizon, if it does.
    let crossing = mix(a, b, saturate(height_a / (height_a - height_b)));
    let rises = height_a < 0.0 && height_b > 0.0;
    let sets = height_a > 0.0 && height_b < 0.0;
    if rises {
        (*o).enters = crossing;
    }
    if sets {
        (*o).leaves = crossing;
    }
    (*o).clipped = (*o).clipped || sets;
    let part = edge_part(select(a, crossing, rises), select(b, crossing, sets), normal);
    (*o).sum += select(part, 0.0, max(height_a, height_b) <= 0.0);
}

// Solid angle weighted by the cosine at the receiver, which is irradiance for unit luminance.
fn outline_irradiance(o: Outline, normal: vec3f) -> f32 {
    return 0.5 * abs(o.sum + select(0.0, edge_part(o.leaves, o.enters, normal), o.clipped));
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
    const STEP: f32 = 2.0 * PI / f32(DISC_CORNERS);
    const TURN: vec2f = vec2f(cos(STEP), sin(STEP));
    let grow = sqrt(STEP / TURN.y);
    var at = vec2f(grow, 0.0);
    var from_corner = centre + at.x * right;
    var o: Outline;
    for (var i = 0u; i < DISC_CORNERS; i++) {
        at = vec2f(at.x * TURN.x - at.y * TURN.y, at.x * TURN.y + at.y * TURN.x);
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

// A light without a size, or the sun.
fn delta_arrival(light: u32, position: vec3f, normal: vec3f, mirror: vec3f) -> Arrival {
    var out: Arrival;
    let kind = lights[light].kind;
    let axis = lights[light].axis;
    let to_light = lights[light].position - position;
    let squared = max(dot(to_light, to_light), 1e-12);
    let direction = to_light * inverseSqrt(squared);
    let cone = spot_falloff(-dot(direction, axis), lights[light].inner_rad, lights[light].outer_rad);
    let near = select(1.0, cone, kind == KIND_SPOT) / squared;
    let is_sun = kind == KIND_SUN;
    let radius = lights[light].radius;
    let toward = select(direction, -axis, is_sun);
    out.perpendicular = select(near, 1.0, is_sun);
    out.irradiance = max(dot(normal, toward), 0.0) * out.perpendicular;
    out.solid_angle = PI * radius * radius;
    out.direction = toward_ball(toward, radius, mirror);
    return out;
}

fn sphere_arrival(light: u32, position: vec3f, normal: vec3f, mirror: vec3f) -> Arrival {
    var out: Arrival;
    let to_light = lights[light].position - position;
    let distance = sqrt(max(dot(to_light, to_light), 1e-12));
    let radius = lights[light].radius;
    out.irradiance = sphere_irradiance(dot(normal, to_light) / distance, distance, radius);
    let sine = min(radius / distance, 1.0);
    out.solid_angle = 2.0 * PI * (1.0 - sqrt(1.0 - sine * sine));
    out.perpendicular = out.solid_angle;
    out.direction = toward_ball(to_light, radius, mirror);
    return out;
}

// A panel but for its irradiance: the highlight comes from where the mirror ray hits the panel's plane, moved into the
// panel. A ray that runs away from the plane counts as hitting it far off.
fn panel_highlight(light: u32, to_light: vec3f, mirror: vec3f, round: bool) -> Arrival {
    var out: Arrival;
    let axis = lights[light].axis;
    let right = lights[light].right;
    let up = lights[light].up;
    let height = max(-dot(to_light, axis), 0.0);
    let hit = mirror * (height / max(-dot(mirror, axis), 1e-3)) - to_light;
    let local = vec2f(dot(hit, right) / dot(right, right), dot(hit, up) / dot(up, up));
    let in_square = clamp(local, vec2f(-1.0), vec2f(1.0));
    let in_disc = local * inverseSqrt(max(dot(local, local), 1.0));
    let nearest = select(in_square, in_disc, round);
    let telling = to_light + nearest.x * right + nearest.y * up;
    let reach = max(dot(telling, telling), 1e-12);
    out.direction = telling * inverseSqrt(reach);
    let flat_angle = lights[light].area_m2 * height * inverseSqrt(reach) / reach;
    out.solid_angle = flat_angle / (1.0 + flat_angle / (2.0 * PI));
    out.perpendicular = out.solid_angle;
    return out;
}

fn rect_arrival(light: u32, position: vec3f, normal: vec3f, mirror: vec3f) -> Arrival {
    let to_light = lights[light].position - position;
    var out = panel_highlight(light, to_light, mirror, false);
    let before = dot(to_light, lights[light].axis) < 0.0;
    out.irradiance = select(0.0, rect_irradiance(to_light, lights[light].right, lights[light].up, normal), before);
    return out;
}

fn disc_arrival(light: u32, position: vec3f, normal: vec3f, mirror: vec3f) -> Arrival {
    let to_light = lights[light].position - position;
    var out = panel_highlight(light, to_light, mirror, true);
    let before = dot(to_light, lights[light].axis) < 0.0;
    out.irradiance = select(0.0, disc_irradiance(to_light, lights[light].right, lights[light].up, normal), before);
    return out;
}
