// Each emitter's light on a surface: exact diffuse irradiance, and a highlight at the emitter's most telling point.

const KIND_POINT: u32 = 0u;
const KIND_SPOT: u32 = 1u;
const KIND_SPHERE: u32 = 2u;
const KIND_RECT: u32 = 3u;
const KIND_DISC: u32 = 4u;
const KIND_SUN: u32 = 5u;

// Falls linearly in angle from the inner to the outer half angle; a step where they are equal.
fn spot_falloff(cosine: f32, inner_rad: f32, outer_rad: f32) -> f32 {
    let angle = acos(clamp(cosine, -1.0, 1.0));
    return select(saturate((outer_rad - angle) / max(outer_rad - inner_rad, 1e-6)), 1.0, angle <= inner_rad);
}

// Arc cosine over sine of an angle with this cosine, to 2e-5: a polynomial through the Chebyshev nodes of 0..1.
fn angle_over_sine(cosine: f32) -> f32 {
    let x = abs(cosine);
    let near = 1.5707675 + x * (-0.9978972 + x * (0.7592518 + x * (-0.5393959 + x * (0.2731272 - 0.0658685 * x))));
    let far = PI * inverseSqrt(max(1.0 - x * x, 1e-12)) - near;
    return select(far, near, cosine >= 0.0);
}

// Angle between two corners as seen from the receiver, times the cosine between their plane's normal and the
// receiver's: one edge's part of Lambert's formula.
fn edge_part(a: vec3f, b: vec3f) -> vec3f {
    let scale = inverseSqrt(max(dot(a, a) * dot(b, b), 1e-30));
    return cross(a, b) * (scale * angle_over_sine(dot(a, b) * scale));
}

// A polygon edge by edge, clipped at the receiver's horizon without a list of corners: a convex polygon leaves and
// enters the upper half once, and the edge between those two points closes it.
struct Outline {
    sum: vec3f,
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
    let part = edge_part(select(a, crossing, rises), select(b, crossing, sets));
    (*o).sum += select(part, vec3f(0.0), max(height_a, height_b) <= 0.0);
}

// Solid angle weighted by the cosine at the receiver, which is irradiance for unit luminance.
fn outline_irradiance(o: Outline, normal: vec3f) -> vec2f {
    let v = o.sum + select(vec3f(0.0), edge_part(o.leaves, o.enters), o.clipped);
    let across = abs(dot(v, normal));
    return vec2f(0.5 * across, across * inverseSqrt(max(dot(v, v), 1e-30)));
}

fn rect_irradiance(centre: vec3f, right: vec3f, up: vec3f, normal: vec3f) -> vec2f {
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

// A hexagon of the disc's area stands for it: within 0.2 % on its axis, however near.
fn disc_irradiance(centre: vec3f, right: vec3f, up: vec3f, normal: vec3f) -> vec2f {
    const HALF_HEIGHT: f32 = 0.866025404;
    const GROW: f32 = 1.09963611;
    let along = right * GROW;
    let half = along * 0.5;
    let high = up * (GROW * HALF_HEIGHT);
    let a = centre + along;
    let b = centre + half + high;
    let c = centre - half + high;
    let d = centre - along;
    let e = centre - half - high;
    let f = centre + half - high;
    var o: Outline;
    add_edge(&o, a, b, normal);
    add_edge(&o, b, c, normal);
    add_edge(&o, c, d, normal);
    add_edge(&o, d, e, normal);
    add_edge(&o, e, f, normal);
    add_edge(&o, f, a, normal);
    return outline_irradiance(o, normal);
}

// Irradiance of a sphere of unit luminance, cut by the horizon (Snyder 1996, area light sources for real-time
// graphics).
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

// Angle over which a barn door's edge goes from light to dark.
const DOOR_EDGE_RAD: f32 = 0.06981317;

// Part of the light that a flap leaves; at 90 degrees it is out of the way.
fn flap(open_rad: f32, angle_rad: f32) -> f32 {
    return select(saturate((open_rad - angle_rad) / DOOR_EDGE_RAD + 0.5), 1.0, open_rad >= 0.5 * PI);
}

// Part that a light's modifier lets pass in a unit direction away from it; twin of `photo::beam::passed`.
fn passed(light: u32, away: vec3f) -> f32 {
    if lights[light].has_beam == 0u {
        return 1.0;
    }
    let cosine = dot(away, lights[light].axis);
    let beam = lights[light].beam_rad;
    var part = spot_falloff(cosine, beam.x, beam.y) * spot_falloff(cosine, 0.0, beam.z);
    let doors = lights[light].doors_rad;
    if min(min(doors.x, doors.y), min(doors.z, doors.w)) < 0.5 * PI {
        let across = atan2(dot(away, normalize(lights[light].right)), max(cosine, 1e-6));
        let up = atan2(dot(away, normalize(lights[light].up)), max(cosine, 1e-6));
        part *= flap(doors.x, -across) * flap(doors.y, across) * flap(doors.z, up) * flap(doors.w, -up);
        part = select(0.0, part, cosine > 0.0);
    }
    return part;
}

// The same over a panel, as the mean over points of it, weighted by what they send to the receiver.
fn panel_passed(light: u32, position: vec3f, normal: vec3f, round: bool) -> f32 {
    if !HAS_BEAMS {
        return 1.0;
    }
    const POINTS: u32 = 36u;
    // A light without a beam takes one turn of the loop, which tests at its end.
    let points = select(1u, POINTS, lights[light].has_beam != 0u);
    var sum = 0.0;
    var total = 1e-12;
    var i = 0u;
    loop {
        // A grid over a rectangle, a sunflower over a disc.
        let radius = sqrt((f32(i) + 0.5) / f32(POINTS));
        let turn = f32(i) * 2.3999632;
        let cell = (vec2f(f32(i % 6u), f32(i / 6u)) + 0.5) / 3.0 - 1.0;
        let at = select(cell, radius * vec2f(cos(turn), sin(turn)), round);
        let to = lights[light].position + at.x * lights[light].right + at.y * lights[light].up - position;
        let squared = max(dot(to, to), 1e-12);
        let away = -to * inverseSqrt(squared);
        let weight = max(-dot(away, normal), 0.0) * max(dot(away, lights[light].axis), 0.0) / squared;
        sum += weight * passed(light, away);
        total += weight;
        i++;
        continuing {
            break if i >= points;
        }
    }
    return select(1.0, sum / total, points > 1u);
}

// A light as a point sees it, before shadow.
struct Arrival {
    // Irradiance, as a factor of the light's colour.
    irradiance: f32,
    // Mean cosine under which it comes.
    cosine: f32,
    // Part that its modifier lets pass.
    passed: f32,
    // Middle of the emitter, and its half axes: none of a size for points.
    centre: vec3f,
    right: vec3f,
    up: vec3f,
}

// What a point, a spot or a sun sends to a place: illuminance normal to its direction (w) and the direction.
fn delta_arrival(light: u32, position: vec3f) -> vec4f {
    let kind = lights[light].kind;
    let axis = lights[light].axis;
    let to_light = lights[light].position - position;
    let squared = max(dot(to_light, to_light), 1e-12);
    let direction = to_light * inverseSqrt(squared);
    let cone = spot_falloff(-dot(direction, axis), lights[light].inner_rad, lights[light].outer_rad);
    var near = select(1.0, cone, kind == KIND_SPOT) * reach(light, to_light) / squared;
    if HAS_BEAMS {
        near *= passed(light, -direction);
    }
    let is_sun = kind == KIND_SUN;
    return vec4f(select(direction, -axis, is_sun), select(near, 1.0, is_sun));
}

fn sphere_arrival(light: u32, position: vec3f, normal: vec3f) -> Arrival {
    var out: Arrival;
    out.centre = lights[light].position - position;
    let squared = max(dot(out.centre, out.centre), 1e-12);
    let direction = out.centre * inverseSqrt(squared);
    let radius = lights[light].radius;
    out.irradiance = sphere_irradiance(dot(normal, direction), sqrt(squared), radius);
    let part = radius * radius / squared;
    out.cosine = out.irradiance / max(PI * part, 1e-12);
    out.passed = 1.0;
    if HAS_BEAMS {
        out.passed = passed(light, -direction);
    }
    // The disc that covers the ball from here.
    let sine = min(radius * inverseSqrt(squared), 0.99);
    let across = cross(direction, select(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 1.0, 0.0), abs(direction.y) < 0.9));
    out.right = across * (inverseSqrt(dot(across, across)) * radius * inverseSqrt(1.0 - sine * sine));
    out.up = cross(direction, out.right);
    return out;
}

fn panel_arrival(light: u32, position: vec3f, normal: vec3f, round: bool) -> Arrival {
    var out: Arrival;
    out.centre = lights[light].position - position;
    out.right = lights[light].right;
    out.up = lights[light].up;
    var lit: vec2f;
    if round {
        lit = disc_irradiance(out.centre, out.right, out.up, normal);
    } else {
        lit = rect_irradiance(out.centre, out.right, out.up, normal);
    }
    out.cosine = lit.y;
    out.irradiance = select(0.0, lit.x, dot(out.centre, lights[light].axis) < 0.0);
    out.passed = panel_passed(light, position, normal, round);
    return out;
}

// 1 as far as a light reaches, falling to 0 over the last fifth of the way.
fn reach(light: u32, to_light: vec3f) -> f32 {
    if !REACH {
        return 1.0;
    }
    let reach_m = lights[light].reach_m;
    let part = sqrt(dot(to_light, to_light)) / max(reach_m, 1e-6);
    return select(1.0, saturate(5.0 - 5.0 * part), reach_m > 0.0);
}

// The same for a panel, which reaches less far to its sides: its intensity goes with the cosine.
fn panel_reach(light: u32, to_light: vec3f) -> f32 {
    if !REACH {
        return 1.0;
    }
    let squared = dot(to_light, to_light);
    let cosine = max(-dot(to_light, lights[light].axis) * inverseSqrt(max(squared, 1e-12)), 1e-6);
    let part = sqrt(squared / cosine) / max(lights[light].reach_m, 1e-6);
    return saturate(5.0 - 5.0 * part);
}

fn tile_at(at: vec2f) -> u32 {
    let place = vec2u(at / frame.size * vec2f(f32(TILE_COLUMNS), f32(TILE_ROWS)));
    return (min(place.y, TILE_ROWS - 1u) * TILE_COLUMNS + min(place.x, TILE_COLUMNS - 1u)) * TILE_STRIDE;
}

// One past the last light of each family, among those of a tile or among all. The latter are the same for all pixels,
// and a compiler must see that they are: it then reads each light once and not once a pixel.
fn deltas_end(tile: u32) -> u32 {
    if LISTED {
        return tiles[tile].x;
    }
    return frame.light_ends.x;
}

fn spheres_end(tile: u32) -> u32 {
    if LISTED {
        return tiles[tile].y;
    }
    return frame.light_ends.y;
}

fn rects_end(tile: u32) -> u32 {
    if LISTED {
        return tiles[tile].z;
    }
    return frame.light_ends.z;
}

fn discs_end(tile: u32) -> u32 {
    if LISTED {
        return tiles[tile].w;
    }
    return frame.light_ends.w;
}

// The light at a place in a tile's list.
fn listed_light(tile: u32, place: u32) -> u32 {
    if !LISTED {
        return place;
    }
    let word = tiles[tile + 1u + (place >> 4u)][(place >> 2u) & 3u];
    return (word >> ((place & 3u) * 8u)) & 255u;
}

// A tile may have no light of a family; the loops' first turn then counts nothing.
fn present(place: u32, end: u32) -> f32 {
    return select(1.0, select(0.0, 1.0, place < end), LISTED);
}
