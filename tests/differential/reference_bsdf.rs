//! The scattering of the material model in double precision, written from its description at the head of
//! `src/raytrace/bsdf/mod.rs` and from the literature named here, not from the tracer's code.
//!
//! Directions are in world space and leave the surface; normals are on the side of the outgoing direction.

use crate::studio::statistics::TestRng;
use catchlight::scene::Material;
use glam::{DMat3, DVec3};
use std::f64::consts::{PI, TAU};

/// Alpha below which a GGX lobe counts as a mirror (`src/raytrace/bsdf/ggx.rs`).
const SMOOTH_ALPHA: f64 = 1e-3;

/// A direction sampled from a surface.
pub struct Scattered {
    pub direction: DVec3,
    /// BSDF times cosine over density.
    pub weight: DVec3,
    /// The path is on the other side of the surface.
    pub is_transmitted: bool,
    /// Polarisation that the path accepts from here on.
    pub accepted: Polarisation,
}

/// The linear polarisation that the sensor accepts, as the coherency matrix of the accepted field in world space, of
/// trace 1 (Born and Wolf, "Principles of Optics", section 10.8). Its circular part is left out.
#[derive(Clone, Copy)]
pub struct Polarisation(DMat3);

impl Polarisation {
    /// Accepts all polarisations of light along `direction` alike.
    pub fn none(direction: DVec3) -> Self {
        Polarisation((DMat3::IDENTITY - outer(direction, direction)) * 0.5)
    }

    /// Applies changes of the field that are incoherent to each other. Returns the accepted intensity, and the
    /// normalised polarisation.
    fn through(self, fields: impl IntoIterator<Item = DMat3>) -> (f64, Self) {
        let matrix: DMat3 = fields.into_iter().map(|field| field * self.0 * field.transpose()).sum();
        let intensity = matrix.x_axis.x + matrix.y_axis.y + matrix.z_axis.z;
        (intensity, Polarisation(matrix * (1.0 / intensity.max(1e-300))))
    }
}

/// Returns the matrix a b^T.
fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}

/// Returns a field matrix that scales the s and p parts of a wave from `from` to `to`.
fn field(from: DVec3, to: DVec3, normal: DVec3, amplitude_s: f64, amplitude_p: f64) -> DMat3 {
    let s = from.cross(normal).try_normalize().unwrap_or_else(|| from.any_orthonormal_vector());
    outer(s, s) * amplitude_s + outer(s.cross(to), s.cross(from)) * amplitude_p
}

/// Returns the amplitudes (s, p) that a dielectric interface reflects (Fresnel); both are 1 under total internal
/// reflection, whose phase the model leaves out. `eta` is the index of the far side over that of the near side.
fn fresnel_amplitudes(cos: f64, eta: f64) -> (f64, f64) {
    let sin2_t = (1.0 - cos * cos) / (eta * eta);
    if sin2_t >= 1.0 {
        return (1.0, 1.0);
    }
    let cos_t = (1.0 - sin2_t).sqrt();
    ((cos - eta * cos_t) / (cos + eta * cos_t), (eta * cos - cos_t) / (eta * cos + cos_t))
}

/// Returns the reflectance of a dielectric for unpolarised light.
fn fresnel(cos: f64, eta: f64) -> f64 {
    let (s, p) = fresnel_amplitudes(cos, eta);
    0.5 * (s * s + p * p)
}

/// Returns Smith's Lambda for GGX (Heitz 2014, equation 72), by the cosine to the normal.
fn lambda(cos: f64, alpha: f64) -> f64 {
    let tan2 = (1.0 - cos * cos).max(0.0) / (cos * cos);
    0.5 * ((1.0 + alpha * alpha * tan2).sqrt() - 1.0)
}

/// The directional albedo of a GGX lobe, by the square root of the cosine, and its mean.
struct Albedo {
    entries: Vec<f64>,
    mean: f64,
}

impl Albedo {
    const ENTRIES: usize = 97;

    /// Tabulates a lobe with a reflectance by the cosine at the half vector.
    fn new(alpha: f64, reflectance: impl Fn(f64) -> f64) -> Self {
        let step = 1.0 / (Self::ENTRIES - 1) as f64;
        let entries: Vec<f64> =
            (0..Self::ENTRIES).map(|i| directional_albedo((i as f64 * step).powi(2), alpha, &reflectance)).collect();
        let mut albedo = Albedo { entries, mean: 0.0 };
        // The integral of 2 E(mu) mu dmu with mu = x2
        const STEPS: usize = 2000;
        let terms = (0..STEPS).map(|i| (i as f64 + 0.5) / STEPS as f64).map(|x| 4.0 * albedo.at(x * x) * x.powi(3));
        albedo.mean = terms.sum::<f64>() / STEPS as f64;
        albedo
    }

    fn at(&self, cos: f64) -> f64 {
        let x = cos.clamp(0.0, 1.0).sqrt() * (Self::ENTRIES - 1) as f64;
        let i = (x as usize).min(Self::ENTRIES - 2);
        self.entries[i] + (self.entries[i + 1] - self.entries[i]) * (x - i as f64)
    }
}

/// Integrates F G2 (o.m) / (cos o cos m) over facet normals m of density D(m) cos m, which the substitution
/// tan2 m = alpha2 u / (1 - u) makes uniform in u (Walter et al. 2007, equations 20 and 35).
fn directional_albedo(cos: f64, alpha: f64, reflectance: &impl Fn(f64) -> f64) -> f64 {
    const NORMALS: usize = 96;
    const TURNS: usize = 48;
    if alpha < SMOOTH_ALPHA {
        return reflectance(cos);
    }
    let cos = cos.max(1e-4);
    let sin = (1.0 - cos * cos).sqrt();
    let mut sum = 0.0;
    for i in 0..NORMALS {
        // u = 1 - (1 - v)2 resolves the tail of steep facets; du = 2 (1 - v) dv
        let rest = 1.0 - (i as f64 + 0.5) / NORMALS as f64;
        let tan2_m = alpha * alpha * (1.0 - rest * rest) / (rest * rest);
        let cos_m = (1.0 + tan2_m).powf(-0.5);
        let sin_m = (1.0 - cos_m * cos_m).sqrt();
        for j in 0..TURNS {
            let turn = PI * (j as f64 + 0.5) / TURNS as f64;
            let cos_half = sin * sin_m * turn.cos() + cos * cos_m;
            let cos_i = 2.0 * cos_half * cos_m - cos;
            if cos_half > 0.0 && cos_i > 0.0 {
                let visible = 1.0 / (1.0 + lambda(cos, alpha) + lambda(cos_i, alpha));
                sum += reflectance(cos_half) * visible * cos_half / (cos * cos_m) * 2.0 * rest;
            }
        }
    }
    sum / (NORMALS * TURNS) as f64
}

/// A surface's material.
pub struct Surface {
    base_color: DVec3,
    /// Metallic part of what is not clear.
    metallic: f64,
    /// Clear part.
    clear: f64,
    alpha: f64,
    pub ior: f64,
    absorption_per_m: DVec3,
    /// Luminance times colour, cd/m2.
    pub emission: DVec3,
    coat: Albedo,
    metal: Albedo,
}

impl Surface {
    /// Converts a material.
    pub fn new(material: &Material) -> Self {
        let alpha = f64::from(material.roughness).powi(2);
        let ior = f64::from(material.ior);
        let clear = f64::from(material.transmission) * (1.0 - f64::from(material.metallic));
        let rgb = |color: [f32; 3]| DVec3::from(color.map(f64::from));
        Surface {
            base_color: rgb(material.base_color),
            metallic: if clear < 1.0 { f64::from(material.metallic) / (1.0 - clear) } else { 0.0 },
            clear,
            alpha,
            ior,
            absorption_per_m: rgb(material.absorption_per_m),
            emission: rgb(material.emission_cd_m2),
            coat: Albedo::new(alpha, |cos| fresnel(cos, ior)),
            metal: Albedo::new(alpha, |_| 1.0),
        }
    }

    /// Returns the transmittance over a distance inside, metres (Beer-Lambert).
    pub fn transmittance(&self, distance: f64) -> DVec3 {
        if distance.is_finite() { (-self.absorption_per_m * distance).exp() } else { DVec3::ONE }
    }

    /// Returns true if light goes through.
    pub fn is_clear(&self) -> bool {
        self.clear > 0.0
    }

    /// Samples a direction. `eta` is the index of the far side over that of the near side; none for a thin pane.
    pub fn scatter(
        &self,
        wo: DVec3,
        normal: DVec3,
        eta: Option<f64>,
        accepted: Polarisation,
        rng: &mut TestRng,
    ) -> Option<Scattered> {
        if f64::from(rng.uniform()) >= self.clear {
            return self.scatter_opaque(wo, normal, rng);
        }
        // A body has its colour at both faces together, a pane at once (Burley 2015)
        let (sample, color) = match eta {
            Some(eta) => (refract_or_reflect(wo, normal, eta, accepted, rng), self.base_color.map(f64::sqrt)),
            None => (self.cross_pane(wo, normal, accepted, rng), self.base_color),
        };
        let weight = if sample.is_transmitted { sample.weight * color } else { sample.weight };
        Some(Scattered { weight, ..sample })
    }

    /// Reflects at or crosses a thin pane: the sum of all inner reflections, (1 - R) / (1 + R) for each polarisation.
    fn cross_pane(&self, wo: DVec3, normal: DVec3, accepted: Polarisation, rng: &mut TestRng) -> Scattered {
        let (s, p) = fresnel_amplitudes(wo.dot(normal), self.ior);
        // Amplitudes of light that passed both faces after so many inner reflections
        let passed = |count: i32, r: f64| (1.0 - r * r) * (-r).powi(count);
        let largest = s.abs().max(p.abs());
        let last = if largest > 0.0 { (1e-6_f64.ln() / largest.ln()).min(1e4) as i32 } else { 0 };
        let through = (0..=last).step_by(2).map(|count| field(-wo, -wo, normal, passed(count, s), passed(count, p)));
        let reflected = mirrored(wo, normal);
        let back = (1..=last).step_by(2).map(|count| field(-wo, reflected, normal, passed(count, s), passed(count, p)));
        let (transmittance, after) = accepted.through(through);
        if f64::from(rng.uniform()) < transmittance {
            return Scattered { is_transmitted: true, accepted: after, ..scattered(-wo, DVec3::ONE) };
        }
        let (_, after) = accepted.through(back.chain([field(-wo, reflected, normal, s, p)]));
        Scattered { accepted: after, ..scattered(reflected, DVec3::ONE) }
    }

    fn scatter_opaque(&self, wo: DVec3, normal: DVec3, rng: &mut TestRng) -> Option<Scattered> {
        let tangent = normal.any_orthonormal_vector();
        let to_world = DMat3::from_cols(tangent, normal.cross(tangent), normal);
        let o = to_world.transpose() * wo;
        let o = DVec3::new(o.x, o.y, o.z.max(1e-9));

        // Sample a facet or the diffuse base
        let gloss = self.metallic + (1.0 - self.metallic) * self.coat_albedo(o.z);
        let matte = (1.0 - self.metallic) * (1.0 - self.coat_albedo(o.z)) * self.base_color.max_element();
        let probability = if matte > 0.0 { (gloss / (gloss + matte)).min(0.9) } else { 1.0 };
        let is_glossy = f64::from(rng.uniform()) < probability;
        let is_smooth = self.alpha < SMOOTH_ALPHA;
        if is_glossy && is_smooth {
            let weight = self.facet_reflectance(o.z, o.z) / probability;
            return Some(scattered(mirrored(wo, normal), weight));
        }
        let i = if is_glossy {
            let m = visible_normal(o, self.alpha, rng);
            2.0 * o.dot(m) * m - o
        } else {
            cosine_direction(rng)
        };
        if i.z <= 0.0 {
            return None;
        }

        // Evaluate base and facets, and the density of both
        let diffuse = self.base_color * ((1.0 - self.metallic) * self.diffuse_coupling(o.z, i.z) / PI);
        let (mut value, mut density) = (diffuse * i.z, (1.0 - probability) * i.z / PI);
        if !is_smooth {
            let m = (o + i).normalize();
            let a2 = self.alpha * self.alpha;
            let distribution = a2 / (PI * (m.z * m.z * a2 + m.x * m.x + m.y * m.y).powi(2));
            let (shadow_o, shadow_i) = (lambda(o.z, self.alpha), lambda(i.z, self.alpha));
            let shape = distribution / (4.0 * o.z);
            value += self.facet_reflectance(o.z, o.dot(m)) * (shape / (1.0 + shadow_o + shadow_i));
            density += probability * shape / (1.0 + shadow_o);
        }
        Some(scattered(to_world * i, value / density))
    }

    /// Returns the reflectance of facets: a dielectric's, and a metal's by Schlick (1994) with Turquin's compensation
    /// (2019) for light between facets.
    fn facet_reflectance(&self, cos_o: f64, cos_half: f64) -> DVec3 {
        let schlick = self.base_color + (1.0 - self.base_color) * (1.0 - cos_half).clamp(0.0, 1.0).powi(5);
        let compensation = 1.0 + self.base_color * (1.0 / self.metal.at(cos_o) - 1.0);
        let coat = if self.ior == 1.0 { 0.0 } else { fresnel(cos_half, self.ior) };
        schlick * compensation * self.metallic + DVec3::splat(coat * (1.0 - self.metallic))
    }

    /// Returns the part of light that passes the coat twice (Kelemen and Szirmay-Kalos 2001).
    fn diffuse_coupling(&self, cos_o: f64, cos_i: f64) -> f64 {
        (1.0 - self.coat_albedo(cos_o)) * (1.0 - self.coat_albedo(cos_i)) / (1.0 - self.coat.mean)
    }

    fn coat_albedo(&self, cos: f64) -> f64 {
        // An exact value for the smooth coat, which is not resolved by a table
        if self.alpha < SMOOTH_ALPHA { fresnel(cos, self.ior) } else { self.coat.at(cos) }
    }
}

fn scattered(direction: DVec3, weight: DVec3) -> Scattered {
    Scattered { direction, weight, is_transmitted: false, accepted: Polarisation::none(direction) }
}

fn mirrored(wo: DVec3, normal: DVec3) -> DVec3 {
    2.0 * wo.dot(normal) * normal - wo
}

/// Reflects or refracts at an interface by Fresnel's equations for the accepted polarisation, and Snell's law. Radiance
/// is scaled by 1 / eta2 (Veach 1997, section 5.2).
fn refract_or_reflect(wo: DVec3, normal: DVec3, eta: f64, accepted: Polarisation, rng: &mut TestRng) -> Scattered {
    let cos = wo.dot(normal).clamp(0.0, 1.0);
    let (s, p) = fresnel_amplitudes(cos, eta);
    let reflected = mirrored(wo, normal);
    let (reflectance, after) = accepted.through([field(-wo, reflected, normal, s, p)]);
    if f64::from(rng.uniform()) < reflectance {
        return Scattered { accepted: after, ..scattered(reflected, DVec3::ONE) };
    }
    let cos_t = (1.0 - (1.0 - cos * cos) / (eta * eta)).max(0.0).sqrt();
    let direction = ((normal * cos - wo) / eta - normal * cos_t).normalize();
    let through = |r: f64| (1.0 - r * r).max(0.0).sqrt();
    let (_, after) = accepted.through([field(-wo, direction, normal, through(s), through(p))]);
    Scattered { direction, weight: DVec3::splat(1.0 / (eta * eta)), is_transmitted: true, accepted: after }
}

fn cosine_direction(rng: &mut TestRng) -> DVec3 {
    let (u, turn) = (f64::from(rng.uniform()), TAU * f64::from(rng.uniform()));
    DVec3::new(u.sqrt() * turn.cos(), u.sqrt() * turn.sin(), (1.0 - u).sqrt())
}

/// Samples a facet normal visible from `o` (Heitz 2018, "Sampling the GGX Distribution of Visible Normals", listing 1).
fn visible_normal(o: DVec3, alpha: f64, rng: &mut TestRng) -> DVec3 {
    let view = DVec3::new(alpha * o.x, alpha * o.y, o.z).normalize();
    let first = DVec3::new(-view.y, view.x, 0.0).try_normalize().unwrap_or(DVec3::X);
    let second = view.cross(first);
    let (radius, turn) = (f64::from(rng.uniform()).sqrt(), TAU * f64::from(rng.uniform()));
    let a = radius * turn.cos();
    let half = 0.5 * (1.0 + view.z);
    let b = (1.0 - half) * (1.0 - a * a).max(0.0).sqrt() + half * radius * turn.sin();
    let h = a * first + b * second + (1.0 - a * a - b * b).max(0.0).sqrt() * view;
    DVec3::new(alpha * h.x, alpha * h.y, h.z.max(1e-12)).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::studio::statistics::{SampleMean, critical_z};

    #[test]
    fn the_mean_reflectance_of_smooth_glass_is_walshs_closed_form() {
        // Walsh 1926: 0.0918 for n = 1.5.
        let glass = Surface::new(&Material { ior: 1.5, roughness: 0.0, ..Material::default() });
        assert!((glass.coat.mean - 0.0918).abs() < 1e-4, "{}", glass.coat.mean);
    }

    /// Returns the mean weight of samples: the albedo.
    fn albedo(surface: &Surface, cos: f64, samples: usize) -> SampleMean {
        let mut rng = TestRng::new(5);
        let wo = DVec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
        SampleMean::of((0..samples).map(|_| {
            let sample = surface.scatter(wo, DVec3::Z, Some(surface.ior), Polarisation::none(-wo), &mut rng);
            sample.map_or(0.0, |s| if s.is_transmitted { s.weight.x * surface.ior.powi(2) } else { s.weight.x })
        }))
    }

    #[test]
    fn white_surfaces_reflect_all_light() {
        let cases = [0.0, 0.05, 0.2, 0.5, 0.6, 1.0].into_iter().flat_map(|r| [1.0, 0.7, 0.3, 0.1].map(|cos| (r, cos)));
        for (roughness, cos) in cases {
            let white = Material { base_color: [1.0; 3], roughness, ..Material::default() };
            for material in [
                Material { metallic: 1.0, ..white.clone() },
                Material { metallic: 0.4, ..white.clone() },
                Material { transmission: 0.5, ..white.clone() },
                white,
            ] {
                let mean = albedo(&Surface::new(&material), cos, 20_000);
                assert!(mean.agrees_with(1.0, 5e-4, 24 * 4), "{roughness} {cos} {material:?}: {mean:?}");
            }
        }
    }

    #[test]
    fn two_faces_of_glass_transmit_by_the_mean_over_polarisations() {
        let (cos, n) = (80.0_f64.to_radians().cos(), 1.52);
        let (s, p) = fresnel_amplitudes(cos, n);
        let expected = 0.5 * ((1.0 - s * s).powi(2) + (1.0 - p * p).powi(2));
        let wo = DVec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
        let mut rng = TestRng::new(6);
        const SAMPLES: usize = 100_000;
        let mean = SampleMean::of((0..SAMPLES).map(|_| {
            let first = refract_or_reflect(wo, DVec3::Z, n, Polarisation::none(-wo), &mut rng);
            let mut second = |s: Scattered| refract_or_reflect(-s.direction, DVec3::Z, 1.0 / n, s.accepted, &mut rng);
            let passes = first.is_transmitted && second(first).is_transmitted;
            f64::from(u8::from(passes))
        }));
        assert!((mean.mean - expected).abs() < critical_z(1) * mean.standard_error, "{mean:?} for {expected}");
    }

    #[test]
    fn parallel_panes_transmit_by_the_mean_over_polarisations() {
        let (cos, n) = (70.0_f64.to_radians().cos(), 1.52);
        let (s, p) = fresnel_amplitudes(cos, n);
        let pane = |r: f64| (1.0 - r * r) / (1.0 + r * r);
        let expected = 0.5 * (pane(s).powi(2) + pane(p).powi(2));
        let wo = DVec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
        let glass = Surface::new(&Material { ior: n as f32, transmission: 1.0, ..Material::default() });
        let mut rng = TestRng::new(7);
        const SAMPLES: usize = 100_000;
        let mean = SampleMean::of((0..SAMPLES).map(|_| {
            let first = glass.cross_pane(wo, DVec3::Z, Polarisation::none(-wo), &mut rng);
            let passes =
                first.is_transmitted && glass.cross_pane(wo, DVec3::Z, first.accepted, &mut rng).is_transmitted;
            f64::from(u8::from(passes))
        }));
        assert!((mean.mean - expected).abs() < critical_z(1) * mean.standard_error, "{mean:?} for {expected}");
    }
}
