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

fn schlick(f0: vec3f, cosine: f32) -> vec3f {
    let x = saturate(1.0 - cosine);
    let x2 = x * x;
    return f0 + (1.0 - f0) * (x2 * x2 * x);
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
    let single = saturate(m.f0 * ab.x + ab.y);
    m.boost = 1.0 + m.f0 * (1.0 / max(ab.x + ab.y, 0.3) - 1.0);
    m.reflectance = single * m.boost;
    m.diffuse = base * (1.0 - gloss.z) * (1.0 - select(max(single.x, max(single.y, single.z)), 0.0, gloss.y == 0.0));
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

// What a mirror shows where no light stands: the room as a box of even paint, or the even ambient light.
fn environment(position: vec3f, direction: vec3f, roughness: f32) -> vec3f {
    let even = frame.ambient / PI;
    if frame.has_room == 0u {
        return even;
    }
    let size = frame.room_size;
    let middle = vec3f(position.x, position.y - 0.5 * size.y, position.z);
    let extent = vec3f(size.x, 0.5 * size.y, size.z);
    let safe = select(direction, vec3f(1e-6), abs(direction) < vec3f(1e-6));
    let t = max((extent - middle) / safe, (-extent - middle) / safe);
    let first = min(t.x, min(t.y, t.z));
    var radiance = frame.wall_radiance;
    if t.y <= first {
        radiance = select(frame.floor_radiance, frame.ceiling_radiance, direction.y > 0.0);
    }
    let mean = (frame.floor_radiance + frame.ceiling_radiance + 2.0 * frame.wall_radiance) * 0.25;
    return mix(radiance, mean, roughness);
}
