//! The bodies of lights in format 1.

use crate::scene::{Bodies, BodyChoice};
use serde::{Deserialize, Serialize};

/// The bodies of all lights. Files without the field have none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename = "Bodies")]
pub(super) enum BodiesV1 {
    On,
    InReflections,
    #[default]
    Off,
}

/// The body of a light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename = "Body")]
pub(super) enum BodyChoiceV1 {
    #[default]
    AsStudio,
    On,
    InReflections,
    Off,
}

same_variants!(BodiesV1 <=> Bodies { On, InReflections, Off });
same_variants!(BodyChoiceV1 <=> BodyChoice { AsStudio, On, InReflections, Off });
