//! Named numbers with a range, and the macro that declares a struct of them.

/// A number of a figure: its name in files, its label, range and unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Name of the field, in files too.
    pub name: &'static str,
    /// Label in the window.
    pub label: &'static str,
    /// Smallest value.
    pub low: f32,
    /// Largest value.
    pub high: f32,
    /// Value of a new figure.
    pub default: f32,
}

/// A set of parameters: a struct of numbers with a table.
pub trait ParameterSet: Copy + Default + PartialEq + 'static {
    /// Name of the struct, in files too.
    const NAME: &'static str;
    /// The fields' names, labels, ranges and defaults, in order.
    const PARAMETERS: &'static [Parameter];

    /// Returns the values in the order of [`ParameterSet::PARAMETERS`].
    fn values(&self) -> Vec<f32>;

    /// Returns the values in the order of [`ParameterSet::PARAMETERS`], to be changed.
    fn values_mut(&mut self) -> Vec<&mut f32>;

    /// Returns the set with each value within its range.
    fn clamped(mut self) -> Self {
        for (value, parameter) in self.values_mut().into_iter().zip(Self::PARAMETERS) {
            *value = value.clamp(parameter.low, parameter.high);
        }
        self
    }
}

/// Declares a struct of `f32` fields with a table of their labels, ranges and defaults.
macro_rules! parameters {
    (
        $(#[$doc:meta])*
        $name:ident {
            $($(#[$field_doc:meta])* $field:ident: $label:literal, $low:literal to $high:literal, $default:literal;)+
        }
    ) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct $name {
            $($(#[$field_doc])* pub $field: f32,)+
        }

        impl $crate::scene::figure::ParameterSet for $name {
            const NAME: &'static str = stringify!($name);
            const PARAMETERS: &'static [$crate::scene::figure::Parameter] = &[
                $($crate::scene::figure::Parameter {
                    name: stringify!($field),
                    label: $label,
                    low: $low as f32,
                    high: $high as f32,
                    default: $default as f32,
                },)+
            ];

            fn values(&self) -> Vec<f32> {
                vec![$(self.$field,)+]
            }

            fn values_mut(&mut self) -> Vec<&mut f32> {
                vec![$(&mut self.$field,)+]
            }
        }

        impl Default for $name {
            fn default() -> Self {
                $name { $($field: $default as f32,)+ }
            }
        }
    };
}

pub(super) use parameters;
