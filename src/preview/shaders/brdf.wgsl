// The one material: Lambert under a GGX coat, or a GGX metal. alpha = roughness^2, height-correlated Smith masking.

struct Material {
    diffuse: vec3f,
    f0: vec3f,
    alpha2: f32,
    // Loss of single scattering given back, by its mean (Turquin 2019).
    boost: vec3f,
    // Directional albedo of the coat or metal.
    reflectance: vec3f,
}

// Schlick's Fresnel; a surface of next to no reflectance (a grey card of index 1) stays without at grazing angles.
fn schlick(f0: vec3f, cosine: f32) -> vec3f {
    let x = saturate(1.0 - cosine);
    let x2 = x * x;
    return f0 + (saturate(50.0 * f0) - f0) * (x2 * x2 * x);
}

// Directional albedo of GGX with f0 as (scale, bias): Karis 2014, physically based shading on mobile.
fn albedo_scale_bias(n_dot_v: f32, roughness: f32) -> vec2f {
    let r = roughness * vec4f(-1.0, -0.0275, -0.572, 0.022) + vec4f(1.0, 0.0425, 1.04, -0.04);
    let a = min(r.x * r.x, exp2(-9.28 * n_dot_v)) * r.x + r.y;
    return vec2f(-1.04, 1.04) * a + r.zw;
}

fn material(base: vec3f, gloss: vec3f, n_dot_v: f32) -> Material {
    var m: Material;
    let alpha = gloss.x * gloss.x;
    // Alpha 0.001: the sharpest highlight that still covers a pixel somewhere.
    m.alpha2 = max(alpha * alpha, 1e-6);
    m.f0 = mix(vec3f(gloss.y * gloss.y), base, gloss.z);
    let ab = albedo_scale_bias(n_dot_v, gloss.x);
    let single = saturate(m.f0 * ab.x + saturate(50.0 * m.f0) * ab.y);
    m.boost = 1.0 + m.f0 * (1.0 / max(ab.x + ab.y, 0.3) - 1.0);
    m.reflectance = single * m.boost;
    m.diffuse = base * (1.0 - gloss.z) * (1.0 - max(single.x, max(single.y, single.z)));
    return m;
}

// Radiance of a light's highlight, as a factor of its colour. The lobe's width adds to the emitter's: where the emitter
// is small this is GGX times its illuminance, where it fills the lobe its luminance times the reflectance.
fn highlight(m: Material, a: Arrival, normal: vec3f, view: vec3f, n_dot_v: f32) -> vec3f {
    let n_dot_l = dot(normal, a.direction);
    if n_dot_l <= 0.0 || a.perpendicular <= 0.0 {
        return vec3f(0.0);
    }
    let half_sum = a.direction + view;
    let half_vector = half_sum * inverseSqrt(max(dot(half_sum, half_sum), 1e-20));
    let across = cross(normal, half_vector);
    let n_dot_h = dot(normal, half_vector);
    let falloff = m.alpha2 / (m.alpha2 * n_dot_h * n_dot_h + dot(across, across));
    let peak = 1.0 / (PI * m.alpha2 + a.solid_angle / (4.0 * n_dot_v));
    let masking = 0.5 / (n_dot_l * sqrt(m.alpha2 + (1.0 - m.alpha2) * n_dot_v * n_dot_v)
        + n_dot_v * sqrt(m.alpha2 + (1.0 - m.alpha2) * n_dot_l * n_dot_l));
    let fresnel = schlick(m.f0, dot(view, half_vector));
    return fresnel * m.boost * (falloff * falloff * peak * masking * n_dot_l * a.perpendicular);
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
