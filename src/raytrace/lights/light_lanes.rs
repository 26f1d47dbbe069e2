//! A few lights side by side, one a lane, for vertices that sample all of them at once.
//!
//! Rectangles, which most studio lights are, are sampled together; lights of other shapes fill their lanes one by one.

use super::rect::RectLanes;
use super::traced_light::{LightSample, LightSource, TracedLight};
use crate::math::Vec3Lanes;
use crate::math::simd::{self, Avx2, LANES, SimdTask};
use glam::{Vec2, Vec3};

/// The lights of a scene that are sampled, one a lane.
#[derive(Clone, Debug)]
pub struct LightLanes {
    /// Index of each lane's light.
    lights: Vec<u32>,
    rects: RectLanes,
    /// Luminance of each lane's rectangle, cd/m2; 0 in lanes of other lights.
    rect_luminance: [f32; LANES],
}

/// Directions towards lights, one a lane, as [`LightSample`].
#[derive(Clone, Copy, Debug)]
pub struct LightSampleLanes {
    /// Unit directions towards the lights.
    pub direction: Vec3Lanes,
    /// Distances to the emitters, metres.
    distance: [f32; LANES],
    /// Luminance over pdf, or illuminance; 0 where no light arrives.
    value: [f32; LANES],
    /// Densities, 1/sr; infinite for delta lights.
    pdf: [f32; LANES],
}

impl LightLanes {
    /// Arranges the lights that are sampled, if there are several and a lane for each.
    pub fn new(lights: &[TracedLight]) -> Option<Self> {
        let sampled: Vec<u32> = (0..).zip(lights).filter(|(_, light)| light.is_sampled()).map(|(i, _)| i).collect();
        if !(2..=LANES).contains(&sampled.len()) {
            return None;
        }
        let (mut rects, mut rect_luminance) = (RectLanes::NONE, [0.0; LANES]);
        for (lane, light) in sampled.iter().enumerate() {
            if let LightSource::Rect { rect, luminance } = &lights[*light as usize].source {
                rects.set_lane(lane, rect);
                rect_luminance[lane] = *luminance;
            }
        }
        Some(LightLanes { lights: sampled, rects, rect_luminance })
    }

    /// Returns the index of each lane's light.
    pub fn lights(&self) -> &[u32] {
        &self.lights
    }

    /// Samples a direction from `point` towards each light, as [`TracedLight::sample`] does, with the lane's two numbers.
    pub fn sample(&self, lights: &[TracedLight], point: Vec3, u: &[[f32; LANES]; 2]) -> LightSampleLanes {
        let mut samples = simd::dispatch(RectSampling { lanes: self, point, u });
        for (lane, light) in self.lights.iter().enumerate() {
            let light = &lights[*light as usize];
            if self.rect_luminance[lane] == 0.0 {
                samples.set_lane(lane, light.sample(point, Vec2::new(u[0][lane], u[1][lane])));
            } else if light.has_beam() {
                samples.value[lane] *= light.beam_transmission(-samples.direction.lane(lane));
            }
        }
        samples
    }
}

/// The sampling of the rectangles of all lanes, without their modifiers.
struct RectSampling<'a> {
    lanes: &'a LightLanes,
    point: Vec3,
    u: &'a [[f32; LANES]; 2],
}

impl SimdTask for RectSampling<'_> {
    type Output = LightSampleLanes;

    #[inline(always)]
    fn run(self, _: Option<Avx2>) -> LightSampleLanes {
        let RectSampling { lanes: LightLanes { rects, rect_luminance, .. }, point, u } = self;
        // Sample points by area
        let (mut to, mut pdf) = (Vec3Lanes::ZERO, [0.0; LANES]);
        let mut is_near = [0_u32; LANES];
        for i in 0..LANES {
            let rect = rects.lane(i);
            let by_area = rect.sample_by_area(point, Vec2::new(u[0][i], u[1][i]));
            to.set_lane(i, by_area.0);
            pdf[i] = by_area.1;
            is_near[i] = u32::from(!rect.seen_by_area_from(point).is_far());
        }
        // Sample points of near rectangles by solid angle
        if is_near.iter().any(|is_near| *is_near != 0) {
            for i in 0..LANES {
                let rect = rects.lane(i);
                let seen = rect.seen_by_area_from(point).with_solid_angle();
                let by_angle = seen.sample_by_angle(Vec2::new(u[0][i], u[1][i]));
                let is_by_area = (is_near[i] == 0) | seen.is_sampled_by_area();
                to.set_lane(i, if is_by_area { to.lane(i) } else { by_angle.0 });
                pdf[i] = if is_by_area { pdf[i] } else { by_angle.1 };
            }
        }
        // Describe the directions towards them
        let mut samples =
            LightSampleLanes { direction: Vec3Lanes::ZERO, distance: [0.0; LANES], value: [0.0; LANES], pdf };
        for i in 0..LANES {
            let (to, pdf) = (to.lane(i), pdf[i]);
            let distance = to.length();
            let is_seen = rects.lane(i).is_in_front(point) & (pdf > 0.0) & pdf.is_finite() & (distance > 0.0);
            samples.direction.set_lane(i, to * (1.0 / distance));
            samples.distance[i] = distance;
            samples.value[i] = if is_seen { rect_luminance[i] / pdf } else { 0.0 };
        }
        samples
    }
}

impl LightSampleLanes {
    /// Returns the sample of a lane; none where no light arrives.
    #[inline(always)]
    pub fn lane(&self, lane: usize) -> Option<LightSample> {
        // One that is not a number is kept, so that the film reports it
        (self.value[lane] != 0.0).then(|| LightSample {
            direction: self.direction.lane(lane),
            distance: self.distance[lane],
            value: self.value[lane],
            pdf: Some(self.pdf[lane]).filter(|pdf| pdf.is_finite()),
        })
    }

    fn set_lane(&mut self, lane: usize, sample: Option<LightSample>) {
        let Some(LightSample { direction, distance, value, pdf }) = sample else {
            self.value[lane] = 0.0;
            return;
        };
        self.direction.set_lane(lane, direction);
        (self.distance[lane], self.value[lane]) = (distance, value);
        self.pdf[lane] = pdf.unwrap_or(f32::INFINITY);
    }
}
