//! Textures that are part of the program.

/// A texture that the program draws itself: no file holds it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum BuiltinTexture {
    /// Roughness of a figure's skin by region, for [`super::TextureSlot::MetallicRoughness`].
    SkinGloss,
    /// Fine relief of skin, a square of [`BuiltinTexture::RELIEF_M`] that repeats, for [`super::TextureSlot::Normal`].
    SkinRelief,
    /// Colours of iris and pupil for [`super::TextureSlot::BaseColor`], factors of that of the iris. The iris fills the
    /// picture.
    Iris,
    /// Relief of the iris for [`super::TextureSlot::Normal`], as [`BuiltinTexture::Iris`] lies.
    IrisRelief,
}

impl BuiltinTexture {
    /// All variants.
    pub const ALL: [BuiltinTexture; 4] =
        [BuiltinTexture::SkinGloss, BuiltinTexture::SkinRelief, BuiltinTexture::Iris, BuiltinTexture::IrisRelief];

    /// Side of the square that [`BuiltinTexture::SkinRelief`] shows, metres.
    pub const RELIEF_M: f32 = 0.024;

    /// Returns the name that the window shows.
    pub fn label(self) -> &'static str {
        match self {
            BuiltinTexture::SkinGloss => "Skin gloss",
            BuiltinTexture::SkinRelief => "Skin relief",
            BuiltinTexture::Iris => "Iris",
            BuiltinTexture::IrisRelief => "Iris relief",
        }
    }

    /// Returns the text that scene files use.
    pub fn name(self) -> &'static str {
        match self {
            BuiltinTexture::SkinGloss => "builtin:skin-gloss",
            BuiltinTexture::SkinRelief => "builtin:skin-relief",
            BuiltinTexture::Iris => "builtin:iris",
            BuiltinTexture::IrisRelief => "builtin:iris-relief",
        }
    }
}
