//! Displayed channels, and the false colours of illuminance.

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

/// Lowest and highest stop of the false colour scale.
pub const FALSE_STOPS: (i32, i32) = (-6, 3);

/// sRGB colours of whole stops from the lowest to the highest; twin of `false_color.wgsl`.
const FALSE_COLORS: [[f32; 3]; 10] = [
    [0.05, 0.03, 0.10],
    [0.20, 0.08, 0.36],
    [0.23, 0.22, 0.66],
    [0.13, 0.43, 0.78],
    [0.10, 0.62, 0.70],
    [0.16, 0.70, 0.42],
    [0.55, 0.78, 0.22],
    [0.95, 0.83, 0.16],
    [0.97, 0.53, 0.12],
    [0.85, 0.15, 0.16],
];

/// Returns the sRGB false colour of an illuminance in stops relative to the exposure, in steps of a third of a stop.
pub fn false_color(stops: f32) -> [u8; 3] {
    let (low, high) = (FALSE_STOPS.0 as f32, FALSE_STOPS.1 as f32);
    let thirds = ((3.0 * stops).round() / 3.0).clamp(low, high) - low;
    let index = (thirds.floor() as usize).min(FALSE_COLORS.len() - 2);
    let fraction = thirds - index as f32;
    std::array::from_fn(|i| {
        let value = FALSE_COLORS[index][i] + (FALSE_COLORS[index + 1][i] - FALSE_COLORS[index][i]) * fraction;
        (value * 255.0).round() as u8
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn false_colours_change_in_thirds_of_a_stop_and_are_clamped() {
        assert_eq!(false_color(0.1), false_color(-0.1));
        assert_ne!(false_color(0.2), false_color(0.1));
        assert_eq!(false_color(9.0), false_color(FALSE_STOPS.1 as f32));
        assert_eq!(false_color(f32::NEG_INFINITY), false_color(FALSE_STOPS.0 as f32));
        let all: Vec<_> = (FALSE_STOPS.0..=FALSE_STOPS.1).map(|stop| false_color(stop as f32)).collect();
        assert!(all.windows(2).all(|pair| pair[0] != pair[1]));
        assert_eq!(all.len(), FALSE_COLORS.len());
    }

    #[test]
    fn channel_names_are_unique() {
        let names: std::collections::HashSet<_> = Channel::ALL.iter().map(|channel| channel.name()).collect();
        assert_eq!(names.len(), Channel::ALL.len());
    }
}
