//! The density with which photons start along the curve of the casters.

use std::ops::Range;

/// Number of sections of the curve.
pub const SECTIONS: usize = 8192;
/// Least share of the photons that start uniformly.
const UNIFORM_SHARE: f64 = 0.25;
/// Greatest density relative to a uniform one, the least being [`UNIFORM_SHARE`] or more. Light from sections that were
/// not known to matter comes in photons with more flux, by this ratio: more are spots in the picture, less blur
/// close-ups.
const MAX_DENSITY: f64 = 128.0;

/// A piecewise constant density along the curve of the casters, 0 to 1.
#[derive(Clone, Debug, Default)]
pub struct StartDensity {
    /// Cumulative probabilities of the sections, from 0 to 1. None for a uniform density.
    cumulative: Option<Vec<f64>>,
}

impl StartDensity {
    /// A density in proportion to the importance of each section, and in part uniform.
    pub fn new(importances: &[f64]) -> Self {
        let total: f64 = importances.iter().sum();
        if total <= 0.0 || !total.is_finite() {
            return StartDensity::default();
        }
        let count = importances.len() as f64;
        let greatest = importances.iter().copied().fold(0.0, f64::max) * count / total;
        let guided_share = ((MAX_DENSITY - 1.0) / (greatest - 1.0).max(f64::MIN_POSITIVE)).min(1.0 - UNIFORM_SHARE);
        let mut sum = 0.0;
        let add = |importance: &f64| {
            sum += (1.0 - guided_share) / count + guided_share * importance / total;
            sum
        };
        let cumulative = std::iter::once(0.0).chain(importances.iter().map(add)).collect();
        StartDensity { cumulative: Some(cumulative) }
    }

    /// Returns the position along the curve below which the probability is `u`, in [0, 1).
    pub fn position(&self, u: f64) -> f64 {
        let Some(cumulative) = &self.cumulative else { return u };
        let sections = cumulative.len() - 1;
        let section = cumulative.partition_point(|&before| before <= u).clamp(1, sections) - 1;
        let (low, high) = (cumulative[section], cumulative[section + 1]);
        let within = ((u - low) / (high - low)).clamp(0.0, 1.0);
        (section as f64 + within) / sections as f64
    }

    /// Returns the mean density between two positions, relative to a uniform one.
    pub fn relative_density(&self, span: Range<f64>) -> f32 {
        let length = span.end - span.start;
        if self.cumulative.is_none() || length <= 0.0 {
            return 1.0;
        }
        ((self.probability_before(span.end) - self.probability_before(span.start)) / length) as f32
    }

    /// Returns the probability of a section.
    pub fn section_probability(&self, section: usize) -> f64 {
        self.cumulative.as_ref().map_or(1.0 / SECTIONS as f64, |sums| sums[section + 1] - sums[section])
    }

    /// Returns the probability of positions up to this one.
    fn probability_before(&self, position: f64) -> f64 {
        let Some(cumulative) = &self.cumulative else { return position };
        let sections = cumulative.len() - 1;
        let scaled = position.clamp(0.0, 1.0) * sections as f64;
        let section = (scaled as usize).min(sections - 1);
        let (low, high) = (cumulative[section], cumulative[section + 1]);
        low + (high - low) * (scaled - section as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_have_the_density_that_is_stated() {
        let density = StartDensity::new(&[0.0, 3.0, 0.0, 1.0]);
        // 0.25 uniform, and 0.75 by importance
        let expected = [0.25, 0.25 + 4.0 * 0.75 * 0.75, 0.25, 0.25 + 4.0 * 0.75 * 0.25];
        for (section, expected) in (0..).zip(expected) {
            let low = f64::from(section) / 4.0;
            let density = density.relative_density(low + 0.01..low + 0.2);
            assert!((f64::from(density) - expected).abs() < 1e-6, "{section}: {density}");
        }
        assert_eq!(density.relative_density(0.0..1.0), 1.0);
        for u in [0.0, 0.1, 0.4, 0.7, 0.95, 0.999_999] {
            let position = density.position(u);
            assert!((density.probability_before(position) - u).abs() < 1e-12, "{u}: {position}");
        }
        let uniform = StartDensity::new(&[0.0; 8]);
        assert_eq!((uniform.position(0.3), uniform.relative_density(0.2..0.3)), (0.3, 1.0));
    }

    #[test]
    fn a_patch_shorter_than_the_rounding_of_the_curve_has_a_finite_density() {
        let density = StartDensity::new(&[0.0, 1.0]);
        assert_eq!(density.relative_density(0.7..0.7), 1.0);
        let tiny = density.relative_density(0.7..0.7 + 1e-13);
        assert!((tiny / 1.75 - 1.0).abs() < 0.01, "{tiny}");
    }
}
