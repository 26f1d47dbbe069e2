// The one material: Lambert under a GGX coat, or a GGX metal. alpha = roughness^2, height-correlated Smith masking.

struct Material {
    // Part of the base colour that is diffuse reflectance.
    matte: f32,
    f0: vec3f,
    alpha2: f32,
    // Light lost between facets given back, by its mean (Turquin 2019).
    boost: vec3f,
    // Directional albedo of the coat or metal.
    reflectance: vec3f,
}

// A point to be lit.
struct Shading {
    position: vec3f,
    normal: vec3f,
    // Two directions that make a frame with the normal.
    tangent: vec3f,
    bitangent: vec3f,
    view: vec3f,
    n_dot_v: f32,
    material: Material,
}

// A point with its frame (Duff et al. 2017).
fn shading(position: vec3f, normal: vec3f, view: vec3f, base: vec3f, gloss: vec3f) -> Shading {
    var s: Shading;
    let sign = select(-1.0, 1.0, normal.z >= 0.0);
    let a = -1.0 / (sign + normal.z);
    let b = normal.x * normal.y * a;
    s.tangent = vec3f(1.0 + sign * normal.x * normal.x * a, sign * b, -sign * normal.x);
    s.bitangent = vec3f(b, sign + normal.y * normal.y * a, -normal.y);
    s.position = position;
    s.normal = normal;
    s.view = view;
    s.n_dot_v = max(dot(normal, view), 1e-3);
    s.material = material(base, gloss, s.n_dot_v);
    return s;
}

// Schlick's Fresnel; a surface of next to no reflectance (a grey card of index 1) stays without at grazing angles.
fn schlick(f0: vec3f, cosine: f32) -> vec3f {
    let x = saturate(1.0 - cosine);
    let x2 = x * x;
    return f0 + (saturate(50.0 * f0) - f0) * (x2 * x2 * x);
}

// Directional albedo of GGX under height-correlated Smith masking with Schlick's Fresnel: factors of f0 and f90. Our fit
// of the integral, 0.01 in the mean for cosines over 0.1.
fn albedo_scale_bias(n_dot_v: f32, roughness: f32) -> vec2f {
    let r = roughness;
    let x = n_dot_v;
    let p0 = 2.4759 + x * (-6.1760 + 2.7884 * x);
    let p1 = -5.3802 + x * (18.1899 - 9.3620 * x);
    let p2 = 3.0843 + x * (-11.0647 + 6.1318 * x);
    let whole = saturate(1.0 - r * r * (p0 + r * (p1 + r * p2)));
    let y = 1.0 - x;
    let y2 = y * y;
    let bias = y2 * y2 * y * (1.0 + r * (0.5558 + r * (-10.0677 + r * (15.4936 - 6.9515 * r))));
    return vec2f(whole - bias, bias);
}

fn material(base: vec3f, gloss: vec3f, n_dot_v: f32) -> Material {
    var m: Material;
    let alpha = gloss.x * gloss.x;
    // Alpha 0.001: the sharpest highlight that still covers a pixel somewhere.
    m.alpha2 = max(alpha * alpha, 1e-6);
    m.f0 = mix(vec3f(gloss.y * gloss.y), base, gloss.z);
    let ab = albedo_scale_bias(n_dot_v, gloss.x);
    let single = m.f0 * ab.x + saturate(50.0 * m.f0) * ab.y;
    m.boost = 1.0 + m.f0 * (1.0 / max(ab.x + ab.y, LOWEST_ROUND) - 1.0);
    m.reflectance = single * m.boost;
    m.matte = (1.0 - gloss.z) * (1.0 - max(single.x, max(single.y, single.z)));
    return m;
}

// Smith masking and shadowing, height-correlated, over the two cosines and 4: what D and F are multiplied by.
fn masking(alpha2: f32, n_dot_v: f32, n_dot_l: f32) -> f32 {
    return 0.5 / (n_dot_l * sqrt(alpha2 + (1.0 - alpha2) * n_dot_v * n_dot_v)
        + n_dot_v * sqrt(alpha2 + (1.0 - alpha2) * n_dot_l * n_dot_l));
}

// Highlight of a light without a size, for unit illuminance normal to it.
fn glint(s: Shading, direction: vec3f, radius: f32) -> vec3f {
    let n_dot_l = dot(s.normal, direction);
    let half_sum = direction + s.view;
    let half_vector = half_sum * inverseSqrt(max(dot(half_sum, half_sum), 1e-20));
    let across = cross(s.normal, half_vector);
    let n_dot_h = dot(s.normal, half_vector);
    // A sun's disc widens the lobe.
    let alpha2 = s.material.alpha2 + 0.25 * radius * radius;
    let lobe = alpha2 / (alpha2 * n_dot_h * n_dot_h + dot(across, across));
    let value = lobe * lobe / (PI * alpha2) * masking(s.material.alpha2, s.n_dot_v, max(n_dot_l, 1e-4)) * n_dot_l;
    return schlick(s.material.f0, dot(s.view, half_vector)) * s.material.boost * select(0.0, value, n_dot_l > 0.0);
}

// Least height of a half vector, as a part of the distance: where emitter and viewer face each other over a grazing
// surface, slopes run to infinity. The disc's two axes tell less than the corners of a rectangle and need more.
const LOWEST: f32 = 0.1;
const LOWEST_ROUND: f32 = 0.3;

// Slope of the half vector towards a point of the emitter, in the frame of the normal.
fn slope_to(s: Shading, p: vec3f, lowest: f32) -> vec2f {
    let distance = sqrt(dot(p, p));
    let half_vector = p + s.view * distance;
    let height = max(dot(half_vector, s.normal), lowest * distance);
    return vec2f(dot(half_vector, s.tangent), dot(half_vector, s.bitangent)) / height;
}

// Part of the facets whose slopes lie in a disc of squared radius `reach2` about a slope of squared length `off2`. The
// distribution is that of an even sphere in stereographic projection, so the disc is a cap.
fn facets_in_disc(reach2: f32, off2: f32, alpha2: f32) -> f32 {
    let sum = off2 + alpha2 + reach2;
    return 0.5 - 0.5 * (off2 + alpha2 - reach2) * inverseSqrt(max(sum * sum - 4.0 * off2 * reach2, 1e-30));
}

// One edge's part of the facets whose slopes lie in a polygon. GGX over the plane of slopes is the form factor of that
// plane seen from a height alpha, so Lambert's formula gives it.
fn slope_edge(a: vec2f, b: vec2f, alpha2: f32) -> f32 {
    let scale = inverseSqrt((dot(a, a) + alpha2) * (dot(b, b) + alpha2));
    return (a.x * b.y - a.y * b.x) * scale * angle_over_sine((dot(a, b) + alpha2) * scale);
}

// Where the mirror direction is, in half axes from the middle of what covers these slopes.
fn mirror_place(middle: vec2f, slope_u: vec2f, slope_v: vec2f) -> vec2f {
    let area = slope_u.x * slope_v.y - slope_u.y * slope_v.x;
    let safe_area = select(area, 1e-12, abs(area) < 1e-12);
    return vec2f(slope_v.x * middle.y - slope_v.y * middle.x, slope_u.y * middle.x - slope_u.x * middle.y) / safe_area;
}

// Fresnel and masking for light from the emitter's point that is nearest to the mirror direction.
fn gloss_towards(s: Shading, telling: vec3f) -> vec3f {
    let direction = telling * inverseSqrt(max(dot(telling, telling), 1e-20));
    let half_sum = direction + s.view;
    let half_vector = half_sum * inverseSqrt(max(dot(half_sum, half_sum), 1e-20));
    // That point may be below the horizon while others are not.
    let n_dot_l = max(dot(s.normal, direction), 0.08);
    let v_dot_h = dot(s.view, half_vector);
    let n_dot_h = max(dot(s.normal, half_vector), 0.05);
    let weight = masking(s.material.alpha2, s.n_dot_v, n_dot_l) * 4.0 * n_dot_l * v_dot_h / n_dot_h;
    return schlick(s.material.f0, v_dot_h) * s.material.boost * weight;
}

// Highlight of an emitter of unit luminance with a middle and half axes: mirrored to half vectors it covers a region of
// slopes, and as many facets as have such slopes show it.
fn highlight(s: Shading, a: Arrival, round: bool) -> vec3f {
    if round {
        return disc_highlight(s, a);
    }
    return rect_highlight(s, a);
}

// What a round emitter covers is a disc in the plane of slopes, stretched.
fn disc_highlight(s: Shading, a: Arrival) -> vec3f {
    let left = slope_to(s, a.centre - a.right, LOWEST_ROUND);
    let right = slope_to(s, a.centre + a.right, LOWEST_ROUND);
    let low = slope_to(s, a.centre - a.up, LOWEST_ROUND);
    let high = slope_to(s, a.centre + a.up, LOWEST_ROUND);
    let slope_u = 0.5 * (right - left);
    let slope_v = 0.5 * (high - low);
    let mirror = mirror_place(0.25 * (left + right + low + high), slope_u, slope_v);
    let area = abs(slope_u.x * slope_v.y - slope_u.y * slope_v.x);
    let part = facets_in_disc(area, dot(mirror, mirror) * area, s.material.alpha2);
    let nearest = mirror * inverseSqrt(max(dot(mirror, mirror), 1.0));
    return gloss_towards(s, a.centre + nearest.x * a.right + nearest.y * a.up) * part;
}

// A rectangle is cut at the horizon along `up`. The sides along it are bent in the plane of slopes, most where a tall
// strip stands behind a grazing surface: two chords a side lost a tenth of a stop.
fn rect_highlight(s: Shading, a: Arrival) -> vec3f {
    let rise = dot(s.normal, a.up);
    let above = saturate(0.5 + 0.5 * dot(s.normal, a.centre) / max(abs(rise), 1e-6));
    let up = a.up * above;
    let centre = a.centre + a.up * ((1.0 - above) * sign(rise));
    // Five slopes up the right side, five up the left.
    let right = centre + a.right;
    let left = centre - a.right;
    let r0 = slope_to(s, right - up, LOWEST);
    let r1 = slope_to(s, right - 0.5 * up, LOWEST);
    let r2 = slope_to(s, right, LOWEST);
    let r3 = slope_to(s, right + 0.5 * up, LOWEST);
    let r4 = slope_to(s, right + up, LOWEST);
    let l0 = slope_to(s, left - up, LOWEST);
    let l1 = slope_to(s, left - 0.5 * up, LOWEST);
    let l2 = slope_to(s, left, LOWEST);
    let l3 = slope_to(s, left + 0.5 * up, LOWEST);
    let l4 = slope_to(s, left + up, LOWEST);
    let alpha2 = s.material.alpha2;
    let up_right = slope_edge(r0, r1, alpha2) + slope_edge(r1, r2, alpha2) + slope_edge(r2, r3, alpha2)
        + slope_edge(r3, r4, alpha2);
    let down_left = slope_edge(l4, l3, alpha2) + slope_edge(l3, l2, alpha2) + slope_edge(l2, l1, alpha2)
        + slope_edge(l1, l0, alpha2);
    let around = up_right + slope_edge(r4, l4, alpha2) + down_left + slope_edge(l0, r0, alpha2);
    let mirror = mirror_place(0.5 * (r2 + l2), 0.5 * (r2 - l2), 0.25 * (r4 + l4 - r0 - l0));
    let nearest = clamp(mirror, vec2f(-1.0), vec2f(1.0));
    return gloss_towards(s, centre + nearest.x * a.right + nearest.y * up) * (abs(around) / (2.0 * PI));
}

// What a mirror shows where no light stands: the box around the subjects, the blurrier the rougher the mirror.
fn environment(position: vec3f, direction: vec3f, roughness: f32) -> vec3f {
    let safe = select(direction, vec3f(1e-6), abs(direction) < vec3f(1e-6));
    let t = max((frame.environment_high - position) / safe, (frame.environment_low - position) / safe);
    let by_x = t.x <= min(t.y, t.z);
    let by_y = !by_x && t.y <= t.z;
    let face_x = select(frame.environment_radiance[1].rgb, frame.environment_radiance[0].rgb, direction.x > 0.0);
    let face_y = select(frame.environment_radiance[3].rgb, frame.environment_radiance[2].rgb, direction.y > 0.0);
    let face_z = select(frame.environment_radiance[5].rgb, frame.environment_radiance[4].rgb, direction.z > 0.0);
    let sharp = select(select(face_z, face_y, by_y), face_x, by_x);
    let weight = direction * direction;
    let even = face_x * weight.x + face_y * weight.y + face_z * weight.z;
    return mix(sharp, even, saturate(roughness * 2.0));
}

// Irradiance from all round and from bounces.
fn ambient(normal: vec3f) -> vec3f {
    let weight = normal * normal;
    return frame.ambient
        + select(frame.bounce[1].rgb, frame.bounce[0].rgb, normal.x > 0.0) * weight.x
        + select(frame.bounce[3].rgb, frame.bounce[2].rgb, normal.y > 0.0) * weight.y
        + select(frame.bounce[5].rgb, frame.bounce[4].rgb, normal.z > 0.0) * weight.z;
}
