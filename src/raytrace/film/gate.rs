//! The gate that keeps non-finite values out of every film and meter (invariant 7).

use super::stored::stored_fields;
use crate::raytrace::sampler::SampleId;
use crate::raytrace::sink::{FirstHit, RadianceSink, SeenSurface};
use glam::Vec3;

/// The non-finite contributions of a film, a tile or a meter reading.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NonFiniteReport {
    /// Number of contributions that were discarded.
    pub count: u64,
    /// The sample of the first of them.
    pub first: Option<SampleId>,
}

impl NonFiniteReport {
    /// Returns a finite value; counts and discards any other.
    #[inline]
    pub fn admit(&mut self, sample: SampleId, value: Vec3) -> Option<Vec3> {
        if value.is_finite() {
            return Some(value);
        }
        self.count += 1;
        self.first.get_or_insert(sample);
        None
    }

    /// Adds a later report.
    pub fn merge(&mut self, later: &NonFiniteReport) {
        self.count += later.count;
        self.first = self.first.or(later.first);
    }
}

impl<'a> FromIterator<&'a NonFiniteReport> for NonFiniteReport {
    fn from_iter<I: IntoIterator<Item = &'a NonFiniteReport>>(reports: I) -> Self {
        reports.into_iter().fold(NonFiniteReport::default(), |mut sum, report| {
            sum.merge(report);
            sum
        })
    }
}

/// A sink that passes on the finite contributions of one sample and reports the others, which thus count as black.
#[derive(Debug)]
pub struct NonFiniteGate<'a, S> {
    /// Destination of the finite contributions.
    pub sink: S,
    /// The sample that is traced.
    pub sample: SampleId,
    /// Report of the others.
    pub report: &'a mut NonFiniteReport,
}

impl<S: RadianceSink> RadianceSink for NonFiniteGate<'_, S> {
    #[inline]
    fn add(&mut self, layer: usize, value: Vec3) {
        if let Some(value) = self.report.admit(self.sample, value) {
            self.sink.add(layer, value);
        }
    }

    #[inline]
    fn first_hit(&mut self, hit: impl FnOnce() -> FirstHit) {
        let NonFiniteGate { sink, sample, report } = self;
        sink.first_hit(|| {
            // What the film adds up must be finite; distance and object are values of one sample
            let FirstHit { ray, distance, normal, albedo, object } = hit();
            let mut admit = |value: Vec3| report.admit(*sample, value).unwrap_or_default();
            FirstHit { ray, distance, normal: admit(normal), albedo: admit(albedo), object }
        });
    }

    #[inline]
    fn seen_surface(&mut self, surface: impl FnOnce() -> SeenSurface) {
        // Not reported: `first_hit` and `add` report the same surface
        let finite = |value: Vec3| if value.is_finite() { value } else { Vec3::ZERO };
        self.sink.seen_surface(|| {
            let SeenSurface { albedo, normal } = surface();
            SeenSurface { albedo: finite(albedo), normal: finite(normal) }
        });
    }
}

stored_fields!(SampleId { x, y, index, seed });
stored_fields!(NonFiniteReport { count, first });

#[cfg(test)]
mod tests {
    use super::*;

    struct Sum(Vec3);

    impl RadianceSink for Sum {
        fn add(&mut self, _layer: usize, value: Vec3) {
            self.0 += value;
        }
    }

    #[test]
    fn non_finite_contributions_are_counted_and_the_first_is_reported() {
        let sample = |index| SampleId { x: 3, y: 4, index, seed: 5 };
        let mut report = NonFiniteReport::default();
        let mut total = Vec3::ZERO;
        for index in 0..4 {
            let mut gate = NonFiniteGate { sink: Sum(Vec3::ZERO), sample: sample(index), report: &mut report };
            gate.add(0, Vec3::ONE);
            if index > 0 {
                gate.add(0, Vec3::new(f32::NAN, 1.0, 1.0));
                gate.add(1, Vec3::INFINITY);
            }
            total += gate.sink.0;
        }
        assert_eq!(total, Vec3::splat(4.0));
        assert_eq!(report, NonFiniteReport { count: 6, first: Some(sample(1)) });
        let empty = NonFiniteReport::default();
        assert_eq!([empty, report, report].iter().collect::<NonFiniteReport>().count, 12);
    }
}
