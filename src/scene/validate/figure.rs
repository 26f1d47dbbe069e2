//! Checks the parameters of a figure. Body measures out of range are errors; angles beyond the limit of a joint are
//! warnings, since the joint stops there.

use super::check::{Allowed, Check};
use crate::scene::{Figure, ParameterSet, SEAT_RANGE_M};

pub(super) fn check_figure(figure: &Figure, check: &mut Check) {
    check_set("shape.body", &figure.body, check);
    check_set("shape.face", &figure.face, check);
    check_set("shape.expression", &figure.expression, check);
    let pose = &figure.pose;
    if let Some(seat_m) = pose.seat_m {
        check.number("shape.pose.seat_m", seat_m, Allowed::between(SEAT_RANGE_M[0], SEAT_RANGE_M[1], "m"));
    }
    check_joints("shape.pose.torso", &pose.torso, check);
    for (side, (arm, leg)) in ["left", "right"].into_iter().zip(pose.arms.iter().zip(&pose.legs)) {
        check_joints(&format!("shape.pose.{side}_arm"), arm, check);
        check_joints(&format!("shape.pose.{side}_leg"), leg, check);
    }
}

fn check_set<S: ParameterSet>(place: &str, set: &S, check: &mut Check) {
    for (value, parameter) in set.values().into_iter().zip(S::PARAMETERS) {
        check.number(
            &format!("{place}.{}", parameter.name),
            value,
            Allowed::between(parameter.low, parameter.high, ""),
        );
    }
}

fn check_joints<S: ParameterSet>(place: &str, set: &S, check: &mut Check) {
    for (value, parameter) in set.values().into_iter().zip(S::PARAMETERS) {
        let field = format!("{place}.{}", parameter.name);
        let stop = value.clamp(parameter.low, parameter.high);
        if !value.is_finite() {
            check.number(&field, value, Allowed::between(parameter.low, parameter.high, ""));
        } else if stop != value {
            check.warning(&field, format!("{value} is beyond the limit of the joint, which stops at {stop}"));
        }
    }
}
