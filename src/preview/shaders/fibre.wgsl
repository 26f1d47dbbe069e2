// The fibre: the lobes of the path tracer's `bsdf/fibre.rs` (Chiang et al. 2016), averaged over the width of the fibre,
// for a ribbon is a pixel wide.
//
// R is exact for a smooth cylinder: its azimuthal density over all offsets is cos(phi / 2) / 4, with the offset
// sin(phi / 2). TT and TRT are averaged over two offsets on either side, the others are uniform. Light that passes
// several strands is estimated: see `scattered_visibility`.

const FIBRE_IOR: f32 = 1.55;
// Offsets at which TT and TRT are evaluated: in the middle of each quarter of the width.
const FIBRE_OFFSETS: vec2f = vec2f(0.25, 0.75);
// Tilts of R, TT and TRT by the scales, radians: 4, -2 and -8 degrees.
const FIBRE_TILTS: vec3f = vec3f(0.069813, -0.034907, -0.139626);

// Number of strands that light passes on its way into shadowed hair, for an estimate.
const STRANDS_IN_SHADOW: f32 = 5.0;

struct Fibre {
    tangent: vec3f,
    facing: vec3f,
    across: vec3f,
    // Sine and cosine of the longitude of the view direction.
    longitude: vec2f,
    // Variance of R, and scale of the azimuthal lobes.
    variance: f32,
    scale: f32,
    // Azimuths of TT and TRT at both offsets.
    azimuth_tt: vec2f,
    azimuth_trt: vec2f,
    tt_0: vec3f,
    tt_1: vec3f,
    trt_0: vec3f,
    trt_1: vec3f,
    others: vec3f,
    // Albedo, all lobes.
    albedo: vec3f,
    // Part of the light that passes the strands in front of a shadowed one.
    passed: vec3f,
}

fn fibre_fresnel(cosine: f32) -> f32 {
    let c = saturate(cosine);
    let g = sqrt(FIBRE_IOR * FIBRE_IOR - 1.0 + c * c);
    let a = (g - c) / (g + c);
    let b = (c * (g + c) - 1.0) / (c * (g - c) + 1.0);
    return 0.5 * a * a * (1.0 + b * b);
}

// Returns I0(x) exp(-x), to 0.3 % (Olivares et al. 2018).
fn scaled_bessel(x: f32) -> f32 {
    let x2 = x * x;
    return 0.5 * (1.0 + exp(-2.0 * x)) / sqrt(sqrt(1.0 + 0.25 * x2)) * (1.0 + 0.24273 * x2) / (1.0 + 0.43023 * x2);
}

// Returns the longitudinal density for the sines and cosines of two longitudes.
fn longitudinal(incident: vec2f, outgoing: vec2f, variance: f32) -> f32 {
    let both = incident.y * outgoing.y;
    let exponent = (both - incident.x * outgoing.x - 1.0) / variance;
    return scaled_bessel(both / variance) * exp(exponent) / (variance * (1.0 - exp(-2.0 / variance)));
}

fn logistic(angle: f32, scale: f32) -> f32 {
    let wrapped = angle - 2.0 * PI * round(angle / (2.0 * PI));
    let e = exp(-abs(wrapped) / scale);
    return e / (scale * (1.0 + e) * (1.0 + e));
}

fn tilted(longitude: vec2f, tilt: f32) -> vec2f {
    let turn = vec2f(sin(tilt), cos(tilt));
    return vec2f(longitude.x * turn.y + longitude.y * turn.x, abs(longitude.y * turn.y - longitude.x * turn.x));
}

// Returns the fibre at a surface, whose base colour is the absorption, roughness the variance, metallic the azimuthal
// scale.
fn fibre(tangent: vec3f, view: vec3f, surface: Surface) -> Fibre {
    var f: Fibre;
    f.tangent = tangent;
    let sine = clamp(dot(view, tangent), -0.999, 0.999);
    f.longitude = vec2f(sine, sqrt(1.0 - sine * sine));
    f.facing = (view - tangent * sine) / f.longitude.y;
    f.across = cross(tangent, f.facing);
    f.variance = surface.roughness;
    f.scale = surface.metallic;
    let cos_t = sqrt(1.0 - sine * sine / (FIBRE_IOR * FIBRE_IOR));
    let ior = sqrt(FIBRE_IOR * FIBRE_IOR - sine * sine) / f.longitude.y;
    let sin_gamma = FIBRE_OFFSETS / ior;
    let gamma_o = asin(FIBRE_OFFSETS);
    let gamma_t = asin(sin_gamma);
    f.azimuth_tt = PI + 2.0 * gamma_t - 2.0 * gamma_o;
    f.azimuth_trt = 4.0 * gamma_t - 2.0 * gamma_o;
    let chord = 2.0 * sqrt(1.0 - sin_gamma * sin_gamma) / cos_t;
    let cos_o = sqrt(1.0 - FIBRE_OFFSETS * FIBRE_OFFSETS) * f.longitude.y;
    let r_0 = fibre_fresnel(cos_o.x);
    let r_1 = fibre_fresnel(cos_o.y);
    let t_0 = exp(-surface.base_color * chord.x);
    let t_1 = exp(-surface.base_color * chord.y);
    f.tt_0 = t_0 * ((1.0 - r_0) * (1.0 - r_0));
    f.tt_1 = t_1 * ((1.0 - r_1) * (1.0 - r_1));
    f.trt_0 = f.tt_0 * t_0 * r_0;
    f.trt_1 = f.tt_1 * t_1 * r_1;
    f.others = 0.5 * (f.trt_0 * t_0 * r_0 / (1.0 - t_0 * r_0) + f.trt_1 * t_1 * r_1 / (1.0 - t_1 * r_1));
    f.albedo = 0.5 * (r_0 + r_1 + f.tt_0 + f.tt_1 + f.trt_0 + f.trt_1) + f.others;
    let behind_hair = pow(min(f.albedo, vec3f(1.0)), vec3f(STRANDS_IN_SHADOW));
    f.passed = select(behind_hair, vec3f(0.0), (surface.flags & FLAG_SHORT_FIBRE) != 0u);
    return f;
}

// Returns the mean of an azimuthal lobe over an offset on either side.
fn both_sides(azimuth: f32, mean: f32, scale: f32) -> f32 {
    return 0.5 * (logistic(azimuth - mean, scale) + logistic(azimuth + mean, scale));
}

// Returns BSDF times cosine for light from a direction, whose source has this squared angular radius.
fn fibre_scatter(f: Fibre, direction: vec3f, angle2: f32) -> vec3f {
    let sine = clamp(dot(direction, f.tangent), -0.999, 0.999);
    let incident = vec2f(sine, sqrt(1.0 - sine * sine));
    let azimuth = atan2(dot(direction, f.across), dot(direction, f.facing));
    let wide = f.variance + 0.25 * angle2;
    let half_cos = cos(0.5 * azimuth);
    let r = fibre_fresnel(f.longitude.y * half_cos) * 0.25 * half_cos;
    let tt = f.tt_0 * both_sides(azimuth, f.azimuth_tt.x, 1.5 * f.scale) + f.tt_1 * both_sides(azimuth, f.azimuth_tt.y, 1.5 * f.scale);
    let trt = f.trt_0 * both_sides(azimuth, f.azimuth_trt.x, 1.5 * f.scale) + f.trt_1 * both_sides(azimuth, f.azimuth_trt.y, 1.5 * f.scale);
    let narrow = 0.25 * f.variance + 0.25 * angle2;
    let broad = 4.0 * f.variance + 0.25 * angle2;
    return longitudinal(incident, tilted(f.longitude, FIBRE_TILTS.x), wide) * r
        + longitudinal(incident, tilted(f.longitude, FIBRE_TILTS.y), narrow) * 0.5 * tt
        + longitudinal(incident, tilted(f.longitude, FIBRE_TILTS.z), broad) * 0.5 * trt
        + longitudinal(incident, f.longitude, broad) * f.others / (2.0 * PI);
}

// Part of the light that strands nearby do not hide, and light that they scatter onwards in all directions, over the
// squared albedo: fitted to the tracer's pictures of a head of hair.
const UNHIDDEN: f32 = 0.95;
const SCATTERED_ONWARDS: f32 = 0.09;

// Returns the light from one direction that a strand among others scatters.
fn hair_scatter(f: Fibre, direction: vec3f, angle2: f32) -> vec3f {
    return UNHIDDEN * fibre_scatter(f, direction, angle2) + f.albedo * f.albedo * (SCATTERED_ONWARDS / (4.0 * PI));
}

// Returns the visibility of a light, with the light that strands in front let pass and scatter onwards.
fn scattered_visibility(f: Fibre, visibility: f32) -> vec3f {
    return mix(f.passed, vec3f(1.0), visibility);
}
