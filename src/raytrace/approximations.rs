//! The approximations of a render's light.

use super::plan::Shortcut;

/// How a render approximates light that has bounced.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Approximations {
    /// Caustics come from photons.
    pub photons: bool,
    /// Light on matte surfaces after a bounce comes from an irradiance cache.
    pub irradiance_cache: bool,
    /// Paths are regularised: gloss that they meet after a diffuse bounce is blurred.
    pub regularisation: bool,
}

impl Approximations {
    /// Returns those that the text of [`Approximations::describe`] names.
    pub fn named_in(text: &str) -> Self {
        let has = |shortcut: Shortcut| text.contains(shortcut.label());
        Approximations {
            photons: has(Shortcut::Photons),
            irradiance_cache: has(Shortcut::IrradianceCache),
            regularisation: has(Shortcut::Regularisation),
        }
    }

    /// Returns the name of a method with the approximations, separated by commas.
    pub fn describe(&self, method: &str) -> String {
        let Approximations { photons, irradiance_cache, regularisation } = *self;
        let used = [
            (photons, Shortcut::Photons),
            (irradiance_cache, Shortcut::IrradianceCache),
            (regularisation, Shortcut::Regularisation),
        ];
        let mut text = method.to_owned();
        for (_, shortcut) in used.iter().filter(|(is_used, _)| *is_used) {
            text += ", ";
            text += shortcut.label();
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_description_names_its_approximations() {
        assert_eq!(Approximations::default().describe("direct"), "direct");
        for bits in 0..8_u32 {
            let [photons, irradiance_cache, regularisation] = [1, 2, 4].map(|bit| bits & bit != 0);
            let approximations = Approximations { photons, irradiance_cache, regularisation };
            let text = approximations.describe("path");
            assert_eq!(Approximations::named_in(&text), approximations, "{text}");
            assert_eq!(text.split(',').count(), 1 + bits.count_ones() as usize);
        }
    }
}
