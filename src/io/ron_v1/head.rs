//! Lamp heads in format 1.

use crate::scene::{DialScale, Head, HeadDial};
use serde::{Deserialize, Serialize};

/// A lamp head by name, with its dial.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename = "Head", deny_unknown_fields)]
pub(super) struct HeadV1 {
    name: String,
    dial: HeadDialV1,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    sync_s: Option<f32>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    hss_loss_stops: Option<f32>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    t01_s: Option<f32>,
}

/// The dial of a head. The list of gear has the same form.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename = "HeadDial", deny_unknown_fields)]
pub(super) struct HeadDialV1 {
    scale: DialScaleV1,
    lowest_stops: f32,
    steps_per_stop: u8,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename = "DialScale", deny_unknown_fields)]
enum DialScaleV1 {
    Fractions,
    Number { full: f32 },
    WattSeconds { full: f32 },
    PerCent,
}

/// The head of a variant's light where it differs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename = "HeadChange", deny_unknown_fields)]
pub(super) enum HeadChangeV1 {
    /// No head of the list of gear.
    NoHead,
    /// This one.
    Head(HeadV1),
}

pub(super) fn head_change_from(file: HeadChangeV1) -> Option<Head> {
    match file {
        HeadChangeV1::NoHead => None,
        HeadChangeV1::Head(head) => Some(head_from(head)),
    }
}

pub(super) fn head_change_to(head: Option<&Head>) -> HeadChangeV1 {
    head.map_or(HeadChangeV1::NoHead, |head| HeadChangeV1::Head(head_to(head)))
}

pub(super) fn head_from(file: HeadV1) -> Head {
    let HeadV1 { name, dial, sync_s, hss_loss_stops, t01_s } = file;
    Head { name, dial: dial.into(), sync_s, hss_loss_stops, t01_s }
}

pub(super) fn head_to(head: &Head) -> HeadV1 {
    let Head { name, dial, sync_s, hss_loss_stops, t01_s } = head;
    HeadV1 { name: name.clone(), dial: (*dial).into(), sync_s: *sync_s, hss_loss_stops: *hss_loss_stops, t01_s: *t01_s }
}

impl From<HeadDialV1> for HeadDial {
    fn from(HeadDialV1 { scale, lowest_stops, steps_per_stop }: HeadDialV1) -> Self {
        let scale = match scale {
            DialScaleV1::Fractions => DialScale::Fractions,
            DialScaleV1::Number { full } => DialScale::Number { full },
            DialScaleV1::WattSeconds { full } => DialScale::WattSeconds { full },
            DialScaleV1::PerCent => DialScale::PerCent,
        };
        HeadDial { scale, lowest_stops, steps_per_stop }
    }
}

impl From<HeadDial> for HeadDialV1 {
    fn from(HeadDial { scale, lowest_stops, steps_per_stop }: HeadDial) -> Self {
        let scale = match scale {
            DialScale::Fractions => DialScaleV1::Fractions,
            DialScale::Number { full } => DialScaleV1::Number { full },
            DialScale::WattSeconds { full } => DialScaleV1::WattSeconds { full },
            DialScale::PerCent => DialScaleV1::PerCent,
        };
        HeadDialV1 { scale, lowest_stops, steps_per_stop }
    }
}
