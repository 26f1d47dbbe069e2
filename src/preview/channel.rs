//! Displayed channels.

/// The quantity that a picture displays.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Channel {
    /// The lit picture.
    #[default]
    Lit,
    /// Base colour: diffuse albedo, or the reflectance of metals.
    BaseColor,
    /// World normals: red right, green up, blue towards the front.
    Normal,
    /// Roughness from 0 (black) to 1.
    Roughness,
    /// Metallic: white for metals.
    Metallic,
    /// Distance along the optical axis, from white at 0.5 m to black at 32 m, logarithmic. In a parallel view from
    /// white at the nearest object to black at the farthest.
    Depth,
    /// A distinct colour per surface.
    Ids,
    /// Direct illuminance in stops, in false colour.
    Illuminance,
}

impl Channel {
    /// All channels.
    pub const ALL: [Channel; 8] = [
        Channel::Lit,
        Channel::BaseColor,
        Channel::Normal,
        Channel::Roughness,
        Channel::Metallic,
        Channel::Depth,
        Channel::Ids,
        Channel::Illuminance,
    ];

    /// The label in menus.
    pub fn label(self) -> &'static str {
        match self {
            Channel::Lit => "Lit",
            Channel::BaseColor => "Base colour",
            Channel::Normal => "Normals",
            Channel::Roughness => "Roughness",
            Channel::Metallic => "Metallic",
            Channel::Depth => "Depth",
            Channel::Ids => "Surfaces apart",
            Channel::Illuminance => "Illuminance",
        }
    }

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Channel::Lit => "lit",
            Channel::BaseColor => "base-color",
            Channel::Normal => "normal",
            Channel::Roughness => "roughness",
            Channel::Metallic => "metallic",
            Channel::Depth => "depth",
            Channel::Ids => "ids",
            Channel::Illuminance => "illuminance",
        }
    }

    /// Returns true if the channel depends on lights.
    pub fn is_lit(self) -> bool {
        matches!(self, Channel::Lit | Channel::Illuminance)
    }

    /// Returns the value of `CHANNEL` in `channel.wgsl`.
    pub(super) fn number(self) -> u32 {
        self as u32
    }
}

/// The specular model.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Gloss {
    /// GGX microfacets with the highlight of the emitter's full shape, as in the path tracer.
    #[default]
    Ggx,
    /// Blinn-Phong lobe towards the emitter's centre: fast, without the emitter's shape.
    BlinnPhong,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn channel_names_are_unique() {
        let names: std::collections::HashSet<_> = Channel::ALL.iter().map(|channel| channel.name()).collect();
        assert_eq!(names.len(), Channel::ALL.len());
    }
}
