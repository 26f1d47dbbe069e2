//! Conversions of enums of the file that have the same variants as one of the scene.

/// Implements both conversions between an enum of the file and one of the scene with the same variants.
macro_rules! same_variants {
    ($file:ident <=> $scene:ident { $($variant:ident $(($x:ident))? $({ $($field:ident),+ })?),+ $(,)? }) => {
        impl From<$file> for $scene {
            fn from(value: $file) -> Self {
                match value {
                    $($file::$variant $(($x))? $({ $($field),+ })? => $scene::$variant $(($x))? $({ $($field),+ })?),+
                }
            }
        }

        impl From<$scene> for $file {
            fn from(value: $scene) -> Self {
                match value {
                    $($scene::$variant $(($x))? $({ $($field),+ })? => $file::$variant $(($x))? $({ $($field),+ })?),+
                }
            }
        }
    };
}

/// Declares an enum of the file with the names of variants of one of the scene, and both conversions.
macro_rules! named_variants {
    ($file:ident as $name:literal <=> $scene:ident { $($variant:ident),+ $(,)? }) => {
        #[derive(Clone, Copy, Debug, serde::Serialize, serde::Deserialize)]
        #[serde(rename = $name)]
        pub(super) enum $file { $($variant),+ }

        same_variants!($file <=> $scene { $($variant),+ });
    };
}
