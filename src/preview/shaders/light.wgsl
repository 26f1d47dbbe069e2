// Irradiance from each kind of light: analytic polygon, disc and sphere form factors, modifiers, light culling.

const KIND_POINT: u32 = 0u;
const KIND_SPOT: u32 = 1u;
const KIND_SPHERE: u32 = 2u;
const KIND_RECT: u32 = 3u;
const KIND_DISC: u32 = 4u;
const KIND_SUN: u32 = 5u;

// Returns the falloff of a cone: linear in angle from the inner to the outer half angle, a step where they are equal.
fn spot_falloff(cosine: f32, inner_rad: f32, outer_rad: f32) -> f32 {
    let angle = acos(clamp(cosine, -1.0, 1.0));
    return select(saturate((outer_rad - angle) / max(outer_rad - inner_rad, 1e-6)), 1.0, angle <= inner_rad);
}

// Returns acos(x) / sin(acos(x)) for a cosine x, to 2e-5: a polynomial through the Chebyshev nodes of 0..1.
fn angle_over_sine(cosine: f32) -> f32 {
    let x = abs(cosine);
    let near = 1.5707675 + x * (-0.9978972 + x * (0.7592518 + x * (-0.5393959 + x * (0.2731272 - 0.0658685 * x))));
    let far = PI * inverseSqrt(max(1.0 - x * x, 1e-12)) - near;
    return select(far, near, cosine >= 0.0);
}

// Returns the contribution of one edge to Lambert's polygon formula: the angle between its ends as seen from the
// receiver times the unit normal of their plane.
fn edge_integral(a: vec3f, b: vec3f) -> vec3f {
    let scale = inverseSqrt(max(dot(a, a) * dot(b, b), 1e-30));
    return cross(a, b) * (scale * angle_over_sine(dot(a, b) * scale));
}

// A polygon that is integrated edge by edge and clipped at the receiver's horizon without a vertex list: a convex
// polygon crosses the horizon downwards and upwards once, and the edge between these points closes it.
struct ClippedPolygon {
    sum: vec3f,
    leaves: vec3f,
    enters: vec3f,
    clipped: bool,
}

fn add_edge(o: ptr<function, ClippedPolygon>, a: vec3f, b: vec3f, normal: vec3f) {
    let height_a = dot(a, normal);
    let height_b = dot(b, normal);
    // Intersect the edge with the horizon plane
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
    let part = edge_integral(select(a, crossing, rises), select(b, crossing, sets));
    (*o).sum += select(part, vec3f(0.0), max(height_a, height_b) <= 0.0);
}

// Returns the irradiance for unit radiance, and the mean cosine of incidence.
fn polygon_irradiance(o: ClippedPolygon, normal: vec3f) -> vec2f {
    let v = o.sum + select(vec3f(0.0), edge_integral(o.leaves, o.enters), o.clipped);
    let across = abs(dot(v, normal));
    return vec2f(0.5 * across, across * inverseSqrt(max(dot(v, v), 1e-30)));
}

fn rect_irradiance(centre: vec3f, right: vec3f, up: vec3f, normal: vec3f) -> vec2f {
    let a = centre - right - up;
    let b = centre + right - up;
    let c = centre + right + up;
    let d = centre - right + up;
    var o: ClippedPolygon;
    add_edge(&o, a, b, normal);
    add_edge(&o, b, c, normal);
    add_edge(&o, c, d, normal);
    add_edge(&o, d, a, normal);
    return polygon_irradiance(o, normal);
}

// Integrates a hexagon of the disc's area: within 0.2 % on the axis at any distance.
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
    var o: ClippedPolygon;
    add_edge(&o, a, b, normal);
    add_edge(&o, b, c, normal);
    add_edge(&o, c, d, normal);
    add_edge(&o, d, e, normal);
    add_edge(&o, e, f, normal);
    add_edge(&o, f, a, normal);
    return polygon_irradiance(o, normal);
}

// Returns the irradiance from a sphere of unit radiance, clipped at the horizon (Snyder 1996, Area Light Sources for
// Real-Time Graphics).
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

// Width of the penumbra of a barn door's edge.
const DOOR_EDGE_RAD: f32 = 0.06981317;

// Returns the transmission of one barn door; at 90 degrees and more it is open.
fn flap(open_rad: f32, angle_rad: f32) -> f32 {
    return select(saturate((open_rad - angle_rad) / DOOR_EDGE_RAD + 0.5), 1.0, open_rad >= 0.5 * PI);
}

// Cosine to the axis of a panel under which its luminance stays; twin of `photo::measured_beam`.
const LEAST_PANEL_COSINE: f32 = 0.1;

// Returns the factor of a measured distribution in a unit direction away from the light; twin of `photo::measured_beam`.
fn measured_factor(light: u32, away: vec3f) -> f32 {
    let layer = lights[light].has_beam >> 1u;
    if layer == 0u {
        return 1.0;
    }
    let right = dot(away, normalize(lights[light].right));
    let up = dot(away, normalize(lights[light].up));
    let ahead = dot(away, lights[light].axis);
    let across = sqrt(right * right + up * up);
    // The plane does not matter on the axis
    let turn = atan2(up, select(right, 1.0, across < 1e-6)) / (2.0 * PI);
    let down = sqrt(saturate(atan2(across, ahead) / PI));
    let size = vec2f(textureDimensions(intensity_tables));
    let at = (vec2f(fract(turn), down) * (size - 1.0) + 0.5) / size;
    let relative = textureSampleLevel(intensity_tables, bounced_light_sampler, at, layer - 1u, 0.0).x;
    let kind = lights[light].kind;
    return relative / select(1.0, max(ahead, LEAST_PANEL_COSINE), kind == KIND_RECT || kind == KIND_DISC);
}

// Returns the transmission of a light's modifier, times its measured distribution, in a unit direction away from the
// light; twin of `photo::beam`.
fn beam_transmission(light: u32, away: vec3f) -> f32 {
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
    return part * measured_factor(light, away);
}

// Returns the mean transmission over points of a panel, weighted by their contribution to the receiver.
fn panel_transmission(light: u32, position: vec3f, normal: vec3f, round: bool) -> f32 {
    if !HAS_BEAMS {
        return 1.0;
    }
    const POINTS: u32 = 36u;
    // The loop tests at its end: a light without a beam takes one iteration
    let points = select(1u, POINTS, lights[light].has_beam != 0u);
    var sum = 0.0;
    var total = 1e-12;
    var i = 0u;
    loop {
        // Sample a 6 x 6 grid over a rectangle, a Vogel spiral over a disc
        let radius = sqrt((f32(i) + 0.5) / f32(POINTS));
        let turn = f32(i) * 2.3999632;
        let cell = (vec2f(f32(i % 6u), f32(i / 6u)) + 0.5) / 3.0 - 1.0;
        let at = select(cell, radius * vec2f(cos(turn), sin(turn)), round);
        let to = lights[light].position + at.x * lights[light].right + at.y * lights[light].up - position;
        let squared = max(dot(to, to), 1e-12);
        let away = -to * inverseSqrt(squared);
        let weight = max(-dot(away, normal), 0.0) * max(dot(away, lights[light].axis), 0.0) / squared;
        sum += weight * beam_transmission(light, away);
        total += weight;
        i++;
        continuing {
            break if i >= points;
        }
    }
    return select(1.0, sum / total, points > 1u);
}

// Unshadowed light at a shading point.
struct IncidentLight {
    // Irradiance for unit colour of the light.
    irradiance: f32,
    // Mean cosine of incidence.
    cosine: f32,
    // Transmission of the modifier.
    transmission: f32,
    // Centre of the emitter relative to the shading point, and its half axes; zero for lights without a size.
    centre: vec3f,
    right: vec3f,
    up: vec3f,
}

// Returns the direction to a point, spot or sun (xyz) and the normal irradiance for unit colour (w).
fn delta_light(light: u32, position: vec3f) -> vec4f {
    let kind = lights[light].kind;
    let axis = lights[light].axis;
    let to_light = lights[light].position - position;
    let squared = max(dot(to_light, to_light), 1e-12);
    let direction = to_light * inverseSqrt(squared);
    let cone = spot_falloff(-dot(direction, axis), lights[light].inner_rad, lights[light].outer_rad);
    var near = select(1.0, cone, kind == KIND_SPOT) * radius_window(light, to_light) / squared;
    if HAS_BEAMS {
        near *= beam_transmission(light, -direction);
    }
    let is_sun = kind == KIND_SUN;
    return vec4f(select(direction, -axis, is_sun), select(near, 1.0, is_sun));
}

fn sphere_light(light: u32, position: vec3f, normal: vec3f) -> IncidentLight {
    var out: IncidentLight;
    out.centre = lights[light].position - position;
    let squared = max(dot(out.centre, out.centre), 1e-12);
    let direction = out.centre * inverseSqrt(squared);
    let radius = lights[light].radius;
    out.irradiance = sphere_irradiance(dot(normal, direction), sqrt(squared), radius);
    let part = radius * radius / squared;
    out.cosine = out.irradiance / max(PI * part, 1e-12);
    out.transmission = 1.0;
    if HAS_BEAMS {
        out.transmission = beam_transmission(light, -direction);
    }
    // Compute the half axes of the disc that has the outline of the sphere
    let sine = min(radius * inverseSqrt(squared), 0.99);
    let across = cross(direction, select(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 1.0, 0.0), abs(direction.y) < 0.9));
    out.right = across * (inverseSqrt(dot(across, across)) * radius * inverseSqrt(1.0 - sine * sine));
    out.up = cross(direction, out.right);
    return out;
}

fn panel_light(light: u32, position: vec3f, normal: vec3f, round: bool) -> IncidentLight {
    var out: IncidentLight;
    out.centre = lights[light].position - position;
    out.right = lights[light].right;
    out.up = lights[light].up;
    var irradiance: vec2f;
    if round {
        irradiance = disc_irradiance(out.centre, out.right, out.up, normal);
    } else {
        irradiance = rect_irradiance(out.centre, out.right, out.up, normal);
    }
    out.cosine = irradiance.y;
    out.irradiance = select(0.0, irradiance.x, dot(out.centre, lights[light].axis) < 0.0);
    out.transmission = panel_transmission(light, position, normal, round);
    return out;
}

// Returns the window of light culling: 1 up to four fifths of the light radius, falling to 0 at the radius.
fn radius_window(light: u32, to_light: vec3f) -> f32 {
    if !LIGHT_CULLING {
        return 1.0;
    }
    let cull_radius_m = lights[light].cull_radius_m;
    let part = sqrt(dot(to_light, to_light)) / max(cull_radius_m, 1e-6);
    return select(1.0, saturate(5.0 - 5.0 * part), cull_radius_m > 0.0);
}

// Returns the window of a panel, whose radius is smaller off axis: its intensity falls with the cosine.
fn panel_radius_window(light: u32, to_light: vec3f) -> f32 {
    if !LIGHT_CULLING {
        return 1.0;
    }
    let squared = dot(to_light, to_light);
    let cosine = max(-dot(to_light, lights[light].axis) * inverseSqrt(max(squared, 1e-12)), 1e-6);
    let part = sqrt(squared / cosine) / max(lights[light].cull_radius_m, 1e-6);
    return saturate(5.0 - 5.0 * part);
}

fn tile_offset(at: vec2f) -> u32 {
    let tile = vec2u(at / frame.size * vec2f(f32(TILE_COLUMNS), f32(TILE_ROWS)));
    return (min(tile.y, TILE_ROWS - 1u) * TILE_COLUMNS + min(tile.x, TILE_COLUMNS - 1u)) * TILE_STRIDE;
}

// One past the last light of each kind, in the tile's list or among all lights. The latter is uniform, and the compiler
// must see that it is: it then loads each light once rather than once per pixel.
fn deltas_end(tile: u32) -> u32 {
    if TILED {
        return tiles[tile].x;
    }
    return frame.light_ends.x;
}

fn spheres_end(tile: u32) -> u32 {
    if TILED {
        return tiles[tile].y;
    }
    return frame.light_ends.y;
}

fn rects_end(tile: u32) -> u32 {
    if TILED {
        return tiles[tile].z;
    }
    return frame.light_ends.z;
}

fn discs_end(tile: u32) -> u32 {
    if TILED {
        return tiles[tile].w;
    }
    return frame.light_ends.w;
}

// Returns the light at an index of a tile's list.
fn tile_light(tile: u32, index: u32) -> u32 {
    if !TILED {
        return index;
    }
    let word = tiles[tile + 1u + (index >> 4u)][(index >> 2u) & 3u];
    return (word >> ((index & 3u) * 8u)) & 255u;
}

// Returns 0 for the first iteration of a loop over a tile without lights of that kind, else 1.
fn present(index: u32, end: u32) -> f32 {
    return select(1.0, select(0.0, 1.0, index < end), TILED);
}
