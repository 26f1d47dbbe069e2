//! Default values of fields that a file may leave out, and the tests by which a writer leaves them out.

use crate::scene::{Camera, Material, Output, Variants};

/// Three numbers, written `(x, y, z)`.
pub(super) type Triple = [f32; 3];

/// Returns true if the value is its type's default.
pub(super) fn is_default<T: PartialEq + Default>(value: &T) -> bool {
    *value == T::default()
}

pub(super) fn yes() -> bool {
    true
}

pub(super) fn is_true(value: &bool) -> bool {
    *value
}

pub(super) fn unit() -> f32 {
    1.0
}

pub(super) fn is_unit(value: &f32) -> bool {
    *value == 1.0
}

pub(super) fn one() -> Triple {
    [1.0; 3]
}

pub(super) fn is_one(value: &Triple) -> bool {
    *value == one()
}

pub(super) fn default_meter_constant() -> f32 {
    Camera::default().meter_constant
}

pub(super) fn is_default_meter_constant(value: &f32) -> bool {
    *value == default_meter_constant()
}

/// Luminous efficacy of a flash, lm s per Ws.
pub(super) fn default_efficacy() -> f32 {
    Output::DEFAULT_EFFICACY
}

pub(super) fn default_roughness() -> f32 {
    Material::default().roughness
}

pub(super) fn default_ior() -> f32 {
    Material::default().ior
}

pub(super) fn is_default_ior(value: &f32) -> bool {
    *value == default_ior()
}

/// Name of the studio itself among its variants.
pub(super) fn studio_name() -> String {
    Variants::STUDIO_NAME.to_owned()
}

pub(super) fn is_studio_name(name: &str) -> bool {
    name == Variants::STUDIO_NAME
}
