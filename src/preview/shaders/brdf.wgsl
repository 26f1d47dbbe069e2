// The material: a Lambertian base under a GGX dielectric coat, or a GGX metal. alpha = roughness^2, height-correlated
// Smith masking and shadowing.

struct Material {
    // Diffuse albedo for unit base colour, averaged over all directions of incidence.
    diffuse: f32,
    alpha2: f32,
    // Dielectric reflectance at normal incidence (F0), its square root, and F90 - F0.
    f0: f32,
    sqrt_f0: f32,
    f90_minus_f0: f32,
    metallic: f32,
    base: vec3f,
    // Multiple scattering compensation of a metal.
    multiscatter: vec3f,
    albedo: Albedo,
    // Reciprocal of the mean transmission of the coat over the hemisphere.
    coat_transmission: f32,
    // Directional albedo of the coat or metal at the view direction.
    reflectance: vec3f,
}

// A shading point.
struct Shading {
    position: vec3f,
    normal: vec3f,
    // Tangent frame.
    tangent: vec3f,
    bitangent: vec3f,
    view: vec3f,
    n_dot_v: f32,
    material: Material,
}

// Returns a shading point with its tangent frame (Duff et al. 2017).
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

// Schlick's Fresnel. F90 vanishes with F0, so that a surface with index 1 (a grey card) has no grazing reflection.
fn schlick(f0: vec3f, cosine: f32) -> vec3f {
    let x = saturate(1.0 - cosine);
    let x2 = x * x;
    return f0 + (saturate(50.0 * f0) - f0) * (x2 * x2 * x);
}

// Fresnel reflectance: exact for the dielectric, Schlick's for the metal.
fn fresnel(m: Material, cosine: f32) -> vec3f {
    let c = saturate(cosine);
    let ior = (1.0 + m.sqrt_f0) / (1.0 - m.sqrt_f0);
    let g = sqrt(max(ior * ior - 1.0 + c * c, 1e-12));
    let a = (g - c) / (g + c);
    let b = (c * (g + c) - 1.0) / (c * (g - c) + 1.0);
    let coat = 0.5 * a * a * (1.0 + b * b);
    return mix(vec3f(coat), schlick(m.base, c) * m.multiscatter, m.metallic);
}

// Directional albedo of GGX under height-correlated Smith masking with Schlick's Fresnel, as a function of the cosine x
// at one roughness: f0 (1 - loss.x - loss.y x - loss.z x^2) + (f90 - f0) bias (1 - x)^5. Our fit of the integral, 0.01
// in the mean for cosines over 0.1.
struct Albedo {
    loss: vec3f,
    bias: f32,
}

fn albedo_fit(r: f32) -> Albedo {
    let r2 = r * r;
    let loss = vec3f(2.4759, -6.1760, 2.7884) + r * vec3f(-5.3802, 18.1899, -9.3620) + r2 * vec3f(3.0843, -11.0647, 6.1318);
    return Albedo(r2 * loss, 1.0 + r * (0.5558 + r * (-10.0677 + r * (15.4936 - 6.9515 * r))));
}

// Returns the factors of f0 and of f90 - f0 in the directional albedo.
fn albedo_at(a: Albedo, x: f32) -> vec2f {
    let y = 1.0 - x;
    let y2 = y * y;
    return vec2f(saturate(1.0 - a.loss.x - x * (a.loss.y + x * a.loss.z)), y2 * y2 * y * a.bias);
}

fn material(base: vec3f, gloss: vec3f, n_dot_v: f32) -> Material {
    var m: Material;
    let alpha = gloss.x * gloss.x;
    // Clamp alpha to 0.001, the sharpest highlight that still covers a pixel
    m.alpha2 = max(alpha * alpha, 1e-6);
    m.sqrt_f0 = gloss.y;
    m.metallic = gloss.z;
    m.base = base;
    m.albedo = albedo_fit(gloss.x);
    let at_view = albedo_at(m.albedo, n_dot_v);
    // Multiple scattering between facets of a metal (Turquin 2019)
    m.multiscatter = 1.0 + base * (1.0 / max(at_view.x, 0.3) - 1.0);
    let f0 = gloss.y * gloss.y;
    let f90_minus_f0 = saturate(50.0 * f0) - f0;
    let coat = f0 * at_view.x + f90_minus_f0 * at_view.y;
    let metal = (base * at_view.x + (1.0 - base) * at_view.y) * m.multiscatter;
    m.reflectance = mix(vec3f(coat), metal, gloss.z);
    // Cosine-weighted mean over the hemisphere
    let mean = f0 * (1.0 - dot(m.albedo.loss, vec3f(1.0, 2.0 / 3.0, 0.5))) + f90_minus_f0 * m.albedo.bias / 21.0;
    m.diffuse = (1.0 - gloss.z) * (1.0 - coat);
    m.coat_transmission = 1.0 / max(1.0 - mean, 1e-3);
    m.f0 = f0;
    m.f90_minus_f0 = f90_minus_f0;
    return m;
}

// Returns the transmission of the coat at a cosine of incidence, relative to its mean over the hemisphere. Base and
// coat are coupled as in the path tracer (Kelemen and Szirmay-Kalos 2001): (1 - E(o))(1 - E(i)) / (1 - mean E).
// `hemisphere_fraction` is the fraction of the hemisphere that the light fills.
fn coat_transmission(m: Material, cosine: f32, hemisphere_fraction: f32) -> f32 {
    let at = albedo_at(m.albedo, saturate(cosine));
    return mix((1.0 - m.f0 * at.x - m.f90_minus_f0 * at.y) * m.coat_transmission, 1.0, hemisphere_fraction);
}

// Returns the height-correlated Smith masking-shadowing G over 4 (n.v)(n.l), the factor of D F.
fn smith_masking(alpha2: f32, n_dot_v: f32, n_dot_l: f32) -> f32 {
    return 0.5 / (n_dot_l * sqrt(alpha2 + (1.0 - alpha2) * n_dot_v * n_dot_v)
        + n_dot_v * sqrt(alpha2 + (1.0 - alpha2) * n_dot_l * n_dot_l));
}

// Returns the highlight of a light without a size for unit normal irradiance.
fn delta_highlight(s: Shading, direction: vec3f, radius: f32) -> vec3f {
    let n_dot_l = dot(s.normal, direction);
    let half_sum = direction + s.view;
    let half_vector = half_sum * inverseSqrt(max(dot(half_sum, half_sum), 1e-20));
    let across = cross(s.normal, half_vector);
    let n_dot_h = dot(s.normal, half_vector);
    // Widen the lobe by the disc of a sun
    let alpha2 = s.material.alpha2 + 0.25 * radius * radius;
    let lobe = alpha2 / (alpha2 * n_dot_h * n_dot_h + dot(across, across));
    let value = lobe * lobe / (PI * alpha2) * smith_masking(s.material.alpha2, s.n_dot_v, max(n_dot_l, 1e-4)) * n_dot_l;
    return fresnel(s.material, dot(s.view, half_vector)) * select(0.0, value, n_dot_l > 0.0);
}

// Smallest height of a half vector relative to the distance: slopes run to infinity where emitter and viewer face each
// other over a grazing surface.
const MIN_HALF_HEIGHT: f32 = 0.03;

// Returns the Blinn-Phong highlight for unit irradiance from a direction of any length. The lobe has the width of the
// GGX lobe and is normalised by (n + 8) / 8 pi (Real-Time Rendering, 4th ed., section 9.8).
fn blinn_phong(s: Shading, towards: vec3f) -> vec3f {
    let direction = towards * inverseSqrt(max(dot(towards, towards), 1e-20));
    let half_sum = direction + s.view;
    let n_dot_h = max(dot(s.normal, half_sum) * inverseSqrt(max(dot(half_sum, half_sum), 1e-20)), 1e-4);
    let exponent = clamp(2.0 / s.material.alpha2 - 2.0, 1.0, 1e4);
    let lobe = (exponent + 8.0) / (8.0 * PI) * exp2(exponent * log2(n_dot_h));
    return mix(vec3f(s.material.f0), s.material.base, s.material.metallic) * select(0.0, lobe, dot(s.normal, direction) > 0.0);
}

// Returns the slope of the half vector towards a point of the emitter, in the tangent frame.
fn slope_to(s: Shading, p: vec3f) -> vec2f {
    let distance = sqrt(dot(p, p));
    let half_vector = p + s.view * distance;
    let height = max(dot(half_vector, s.normal), MIN_HALF_HEIGHT * distance);
    return vec2f(dot(half_vector, s.tangent), dot(half_vector, s.bitangent)) / height;
}

// Returns the contribution of one edge to the integral of GGX over a polygon of slopes. GGX over the slope plane is the
// form factor of that plane seen from a height alpha, so that Lambert's formula applies.
fn slope_edge(a: vec2f, b: vec2f, alpha2: f32) -> f32 {
    let scale = inverseSqrt((dot(a, a) + alpha2) * (dot(b, b) + alpha2));
    return (a.x * b.y - a.y * b.x) * scale * angle_over_sine((dot(a, b) + alpha2) * scale);
}

// Returns the position of the mirror direction in half axes from the centre of a region of slopes.
fn mirror_point(middle: vec2f, slope_u: vec2f, slope_v: vec2f) -> vec2f {
    let area = slope_u.x * slope_v.y - slope_u.y * slope_v.x;
    let safe_area = select(area, 1e-12, abs(area) < 1e-12);
    return vec2f(slope_v.x * middle.y - slope_v.y * middle.x, slope_u.y * middle.x - slope_u.x * middle.y) / safe_area;
}

// Returns Fresnel times masking for light from the representative point of an emitter.
fn specular_weight(s: Shading, representative: vec3f) -> vec3f {
    let direction = representative * inverseSqrt(max(dot(representative, representative), 1e-20));
    let half_sum = direction + s.view;
    let half_vector = half_sum * inverseSqrt(max(dot(half_sum, half_sum), 1e-20));
    // The representative point may lie below the horizon while others do not
    let n_dot_l = max(dot(s.normal, direction), 0.02);
    let v_dot_h = dot(s.view, half_vector);
    let n_dot_h = max(dot(s.normal, half_vector), 0.05);
    let weight = smith_masking(s.material.alpha2, s.n_dot_v, n_dot_l) * 4.0 * n_dot_l * v_dot_h / n_dot_h;
    return fresnel(s.material, v_dot_h) * weight;
}

// Number of strips into which an emitter is split: proportional to its length over its height above the surface, light
// and viewer together, up to the maximum.
const STRIPS_PER_CURVATURE: f32 = 3.0;
const MAX_STRIPS: f32 = 8.0;

// A line across an emitter, clipped at the horizon, with the slopes of its ends.
struct CrossLine {
    left: vec3f,
    right: vec3f,
    left_slope: vec2f,
    right_slope: vec2f,
}

fn cross_line(s: Shading, middle: vec3f, across: vec3f) -> CrossLine {
    let rise = dot(s.normal, across);
    let part = saturate(0.5 + 0.5 * dot(s.normal, middle) / max(abs(rise), 1e-6));
    let m = middle + across * ((1.0 - part) * sign(rise));
    var line: CrossLine;
    line.left = m - across * part;
    line.right = m + across * part;
    line.left_slope = slope_to(s, line.left);
    line.right_slope = slope_to(s, line.right);
    return line;
}

// Returns the highlight of a rectangle or disc of unit radiance: GGX integrated over the region of slopes that the
// emitter's half vectors cover.
//
// The emitter is clipped at the horizon and split into strips along its longer side. Straight edges are curved in the
// slope plane, most for a tall strip light behind a grazing surface, and Fresnel and masking vary along them: the
// stronger the curvature, the more strips.
fn highlight(s: Shading, a: IncidentLight, round: bool) -> vec3f {
    let is_tall = dot(a.up, a.up) >= dot(a.right, a.right);
    let whole = select(a.right, a.up, is_tall);
    let across = select(a.up, a.right, is_tall);
    let rise = dot(s.normal, whole);
    let height = dot(s.normal, a.centre);
    let above = saturate(0.5 + 0.5 * (height + abs(dot(s.normal, across))) / max(abs(rise), 1e-6));
    let along = whole * above;
    let centre = a.centre + whole * ((1.0 - above) * sign(rise));
    let distance = sqrt(dot(centre, centre));
    let curvature = sqrt(dot(along, along)) / max(max(height, 0.0) + s.n_dot_v * distance, 0.05 * distance);
    let strips = clamp(floor(1.5 + STRIPS_PER_CURVATURE * curvature), 2.0, MAX_STRIPS);
    // A disc becomes a regular polygon of its area, two vertices per cross line
    let step = PI / (strips + 1.0);
    let turn = vec2f(cos(step), sin(step));
    var corner = vec2f(sin(0.5 * step), -cos(0.5 * step)) * sqrt(step / turn.y);
    let alpha2 = s.material.alpha2;
    var low = cross_line(s, centre + along * select(-1.0, corner.y, round), across * select(1.0, corner.x, round));
    var low_edge = slope_edge(low.left_slope, low.right_slope, alpha2);
    var sum = vec3f(0.0);
    var k = 1.0;
    loop {
        corner = vec2f(turn.x * corner.x - turn.y * corner.y, turn.x * corner.y + turn.y * corner.x);
        let at = select(2.0 * k / strips - 1.0, corner.y, round);
        let high = cross_line(s, centre + along * at, across * select(1.0, corner.x, round));
        let high_edge = slope_edge(high.left_slope, high.right_slope, alpha2);
        let around = low_edge + slope_edge(low.right_slope, high.right_slope, alpha2) - high_edge
            + slope_edge(high.left_slope, low.left_slope, alpha2);
        let low_middle = 0.5 * (low.left_slope + low.right_slope);
        let high_middle = 0.5 * (high.left_slope + high.right_slope);
        let slope_u = 0.25 * (low.right_slope - low.left_slope + high.right_slope - high.left_slope);
        let slope_v = 0.5 * (high_middle - low_middle);
        // Choose the representative point: the centre of the strip for a wide lobe, the point nearest to the mirror
        // direction for a narrow one
        let mirror = mirror_point(0.5 * (low_middle + high_middle), slope_u, slope_v);
        let extent = vec2f(dot(slope_u, slope_u), dot(slope_v, slope_v));
        let representative = clamp(mirror, vec2f(-1.0), vec2f(1.0)) * extent / (extent + alpha2);
        let middle = 0.25 * (low.left + low.right + high.left + high.right);
        let half_u = 0.25 * (low.right - low.left + high.right - high.left);
        let half_v = 0.25 * (high.left - low.left + high.right - low.right);
        sum += specular_weight(s, middle + representative.x * half_u + representative.y * half_v) * around;
        low = high;
        low_edge = high_edge;
        k += 1.0;
        continuing {
            break if k > strips;
        }
    }
    return abs(sum) / (2.0 * PI);
}
// Returns the radiance of the environment box in a direction; blurred with roughness.
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

// Returns the ambient and bounced irradiance: interpolated between the probes around a point in front of the surface, and
// between three of the six directions (ambient cube, McTaggart 2004).
fn ambient(position: vec3f, normal: vec3f) -> vec3f {
    let at = (position + normal * frame.grid_offset_m - frame.grid_low) * frame.grid_density;
    let texel = clamp(at, vec3f(0.0), frame.grid_counts - 1.0) + 0.5;
    let uv = texel.xy / frame.grid_counts.xy;
    let face = select(vec3f(1.0, 3.0, 5.0), vec3f(0.0, 2.0, 4.0), normal > vec3f(0.0));
    let z = (face * frame.grid_counts.z + texel.z) / (6.0 * frame.grid_counts.z);
    let weight = normal * normal;
    return frame.ambient
        + textureSampleLevel(bounced_light, bounced_light_sampler, vec3f(uv, z.x), 0.0).rgb * weight.x
        + textureSampleLevel(bounced_light, bounced_light_sampler, vec3f(uv, z.y), 0.0).rgb * weight.y
        + textureSampleLevel(bounced_light, bounced_light_sampler, vec3f(uv, z.z), 0.0).rgb * weight.z;
}
