//! The BSDF of surfaces for several directions at once, one a lane: those towards the lights at a vertex, and those of the
//! paths into which one splits. The formulas are those of `surface.rs`, in loops that the compiler vectorizes.

use super::lobe::Lobe;
use super::microfacet::MicrofacetLobe;
use super::sample::BsdfSample;
use super::surface::SurfaceBsdf;
use crate::math::simd::{self, Avx2, LANES, SimdTask};
use crate::math::{Vec3Lanes, warp};
use glam::{Vec2, Vec3};

/// A BSDF times cosine, and its density (1/sr), for one direction a lane.
#[derive(Clone, Copy, Debug)]
pub struct BsdfLanes {
    value: Vec3Lanes,
    pdf: [f32; LANES],
}

impl BsdfLanes {
    /// Zero in all lanes.
    pub const ZERO: Self = BsdfLanes { value: Vec3Lanes::ZERO, pdf: [0.0; LANES] };

    /// Returns the value and the density of a lane.
    #[inline(always)]
    pub fn lane(&self, lane: usize) -> (Vec3, f32) {
        (self.value.lane(lane), self.pdf[lane])
    }

    /// Sets the value and the density of a lane.
    #[inline(always)]
    pub fn set_lane(&mut self, lane: usize, (value, pdf): (Vec3, f32)) {
        self.value.set_lane(lane, value);
        self.pdf[lane] = pdf;
    }
}

/// The random numbers with which a BSDF is sampled, one sample a lane.
#[derive(Clone, Copy, Debug)]
pub struct BsdfNumbers {
    /// Lobe numbers in 0..1.
    pub lobe: [f32; LANES],
    /// Points of the unit square.
    pub u: [[f32; LANES]; 2],
}

/// Samples of lobes that are not delta functions, one a lane.
#[derive(Clone, Copy, Debug)]
pub struct BsdfSampleLanes {
    direction: Vec3Lanes,
    /// Value and density; a density of 0 where the sample contributes nothing.
    bsdf: BsdfLanes,
}

impl BsdfSampleLanes {
    /// Returns the sample of a lane; none for one without contribution.
    #[inline(always)]
    pub fn lane(&self, lane: usize) -> Option<BsdfSample> {
        let (value, pdf) = self.bsdf.lane(lane);
        (pdf > 0.0).then(|| BsdfSample::non_specular(self.direction.lane(lane), value / pdf, pdf))
    }
}

impl SurfaceBsdf<'_> {
    /// Returns what [`SurfaceBsdf::eval`] returns, to the bit, for a direction a lane.
    pub fn eval_lanes(&self, directions: &Vec3Lanes) -> BsdfLanes {
        if self.point.transmission >= 1.0 {
            return BsdfLanes::ZERO;
        }
        simd::dispatch(Evaluation { bsdf: self, directions })
    }

    /// Returns the samples that [`SurfaceBsdf::sample`] returns, to the bit, for the numbers of each lane. None for a
    /// BSDF with a delta lobe, with walks under the surface, or with a normal of its own for the diffuse lobe.
    pub fn sample_lanes(&self, numbers: &BsdfNumbers) -> Option<BsdfSampleLanes> {
        let is_smooth = self.point.has_microfacets() && self.point.is_smooth();
        let is_plain = self.point.transmission <= 0.0 && self.probabilities.base == Lobe::Diffuse;
        if is_smooth || !is_plain || self.has_relief() {
            return None;
        }
        Some(simd::dispatch(Sampling { bsdf: self, numbers }))
    }

    /// Evaluates the lobes for directions in the local frame, times a factor a lane; 0 where that is 0.
    #[inline(always)]
    fn eval_local_lanes(&self, local: &Vec3Lanes, factor: &[f32; LANES]) -> BsdfLanes {
        // Look up the coat's albedo
        let mut cosine = [0.0; LANES];
        for (i, cosine) in cosine.iter_mut().enumerate() {
            *cosine = self.diffuse.cosine(local.lane(i));
        }
        let coat_albedo = self.point.coat_albedo_lanes(&cosine);
        // Sum the lobes
        let mut sum = BsdfLanes::ZERO;
        for (i, coat_albedo) in coat_albedo.into_iter().enumerate() {
            sum.set_lane(i, self.eval_diffuse(local.lane(i), coat_albedo));
        }
        if self.has_gloss() {
            for i in 0..LANES {
                let ((value, pdf), gloss) = (sum.lane(i), self.eval_gloss(local.lane(i)));
                sum.set_lane(i, (value + gloss.0, pdf + gloss.1));
            }
        }
        for (i, factor) in factor.iter().enumerate() {
            let (value, pdf) = sum.lane(i);
            sum.set_lane(i, if *factor > 0.0 { (value * *factor, pdf * *factor) } else { (Vec3::ZERO, 0.0) });
        }
        sum
    }
}

/// The evaluation of a BSDF for one direction a lane.
struct Evaluation<'a> {
    bsdf: &'a SurfaceBsdf<'a>,
    directions: &'a Vec3Lanes,
}

impl SimdTask for Evaluation<'_> {
    type Output = BsdfLanes;

    #[inline(always)]
    fn run(self, _: Option<Avx2>) -> BsdfLanes {
        let Evaluation { bsdf, directions } = self;
        let (mut local, mut opaque) = (Vec3Lanes::ZERO, [0.0; LANES]);
        for (i, opaque) in opaque.iter_mut().enumerate() {
            let direction = directions.lane(i);
            let wi = bsdf.geometry.to_local(direction);
            local.set_lane(i, wi);
            *opaque = if bsdf.is_in_front(wi, direction) { 1.0 - bsdf.point.transmission } else { 0.0 };
        }
        bsdf.eval_local_lanes(&local, &opaque)
    }
}

/// The sampling of a BSDF, one sample a lane.
struct Sampling<'a> {
    bsdf: &'a SurfaceBsdf<'a>,
    numbers: &'a BsdfNumbers,
}

impl SimdTask for Sampling<'_> {
    type Output = BsdfSampleLanes;

    #[inline(always)]
    fn run(self, _: Option<Avx2>) -> BsdfSampleLanes {
        let Sampling { bsdf, numbers: BsdfNumbers { lobe, u } } = self;
        // Sample a direction from one of the lobes
        let mut local = Vec3Lanes::ZERO;
        for (i, (x, y)) in u[0].iter().zip(&u[1]).enumerate() {
            local.set_lane(i, warp::cosine_hemisphere(Vec2::new(*x, *y)));
        }
        if bsdf.point.has_microfacets() {
            for (i, (x, y)) in u[0].iter().zip(&u[1]).enumerate() {
                let gloss = MicrofacetLobe::sample(&bsdf.point, bsdf.geometry.wo, Vec2::new(*x, *y));
                let is_gloss = lobe[i] < bsdf.probabilities.microfacet;
                local.set_lane(i, if is_gloss { gloss } else { local.lane(i) });
            }
        }
        // Discard directions below the surface, and evaluate all lobes in the others
        let (mut direction, mut factor) = (Vec3Lanes::ZERO, [0.0; LANES]);
        for (i, factor) in factor.iter_mut().enumerate() {
            let wi = local.lane(i);
            let world = bsdf.geometry.to_world(wi);
            direction.set_lane(i, world);
            *factor = if bsdf.is_in_front(wi, world) { 1.0 } else { 0.0 };
        }
        BsdfSampleLanes { direction, bsdf: bsdf.eval_local_lanes(&local, &factor) }
    }
}
