//! The mannequins of older scene files: each is read as a person of the same height, with the face in the same place.

use crate::figures::{self, NamedPose};
use crate::scene::{Body, Extent, Figure, HairStyle, Material, Object, Shape, Torso};
use serde::{Deserialize, Serialize};

/// Who a mannequin is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename = "Figure")]
pub(super) enum MannequinV1 {
    Woman,
    Man,
    Child,
    Bust,
}

/// The pose of a mannequin.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename = "Pose")]
pub(super) enum MannequinPoseV1 {
    Standing,
    Contrapposto,
    Seated,
    HeadTurned,
}

/// Name of the part that is `top`, `bottom` and `shoes` today.
const CLOTHES: &str = "clothes";

/// Returns the person in the place of a mannequin.
pub(super) fn person(who: MannequinV1, pose: MannequinPoseV1) -> Figure {
    let (sex, age_years, height_m, hair) = match who {
        MannequinV1::Woman | MannequinV1::Bust => (0.0, 30.0, 1.68, HairStyle::TiedBack),
        MannequinV1::Man => (1.0, 36.0, 1.80, HairStyle::Short),
        MannequinV1::Child => (0.3, 8.0, 1.28, HairStyle::Bob),
    };
    let extent = if who == MannequinV1::Bust { Extent::Bust } else { Extent::Whole };
    let mut figure =
        Figure { body: Body { sex, age_years, height_m, ..Body::default() }, hair, extent, ..Figure::default() };
    figure.pose = match pose {
        MannequinPoseV1::Standing => NamedPose::Standing.pose(),
        MannequinPoseV1::Contrapposto => NamedPose::HandOnHip.pose(),
        MannequinPoseV1::Seated => NamedPose::Seated.pose(),
        MannequinPoseV1::HeadTurned => NamedPose::Standing.pose(),
    };
    if pose == MannequinPoseV1::HeadTurned {
        figure.pose.torso = Torso { head_yaw_deg: 30.0, ..figure.pose.torso };
    }
    if figure.pose.seat_m.is_some() {
        // Seats of 45 cm (a child's of 32 cm), and what the mannequins' long backs had more than a person's.
        let (seat_m, long_back_m) = match who {
            MannequinV1::Woman | MannequinV1::Bust => (0.45, 0.004),
            MannequinV1::Man => (0.45, 0.043),
            MannequinV1::Child => (0.32, 0.026),
        };
        figure.pose.seat_m = Some(seat_m + long_back_m);
        if who == MannequinV1::Child {
            figure.pose.torso.chest_pitch_deg = 10.0;
        }
    }
    figure
}

/// Gives an object that was read as a mannequin the materials of a person's parts: of its clothes to each garment, the
/// usual ones to those that mannequins did not have.
pub(super) fn complete_parts(object: &mut Object) {
    let Shape::Figure(figure) = &object.shape else { return };
    let clothes = object.part_materials.iter().position(|(part, _)| part == CLOTHES);
    let clothes: Option<Material> = clothes.map(|index| object.part_materials.remove(index).1);
    for (part, usual) in figures::default_parts(&object.material, figure) {
        if object.part_materials.iter().any(|(known, _)| *known == part) {
            continue;
        }
        let is_garment = ["top", "bottom", "shoes"].contains(&part.as_str());
        let material = clothes.clone().filter(|_| is_garment).unwrap_or(usual);
        object.part_materials.push((part, material));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    /// The middle of the eyes of each mannequin, metres, as the program shipped them up to its figures of distance
    /// fields.
    const EYES: [(MannequinV1, MannequinPoseV1, [f32; 3]); 10] = [
        (MannequinV1::Woman, MannequinPoseV1::Standing, [0.0, 1.568, 0.073]),
        (MannequinV1::Woman, MannequinPoseV1::HeadTurned, [0.046, 1.568, 0.062]),
        (MannequinV1::Woman, MannequinPoseV1::Seated, [0.0, 1.232, -0.31]),
        (MannequinV1::Man, MannequinPoseV1::Standing, [0.0, 1.68, 0.079]),
        (MannequinV1::Man, MannequinPoseV1::HeadTurned, [0.049, 1.68, 0.066]),
        (MannequinV1::Man, MannequinPoseV1::Seated, [0.0, 1.298, -0.332]),
        (MannequinV1::Child, MannequinPoseV1::Standing, [0.0, 1.173, 0.069]),
        (MannequinV1::Child, MannequinPoseV1::Seated, [0.0, 0.926, -0.208]),
        (MannequinV1::Bust, MannequinPoseV1::Standing, [0.0, 0.457, 0.073]),
        (MannequinV1::Bust, MannequinPoseV1::HeadTurned, [0.046, 0.457, 0.062]),
    ];

    #[test]
    fn a_mannequin_of_an_old_file_is_a_person_with_its_eyes_in_the_same_place() {
        let mut worst = 0.0_f32;
        for (who, pose, eyes) in EYES {
            let figure = person(who, pose);
            let ours = figures::eye_point(&figure);
            let off = ours.distance(Vec3::from(eyes));
            println!("{who:?} {pose:?}: {ours:.3} for {eyes:?}: {off:.3}");
            worst = worst.max(off);
        }
        assert!(worst < 0.02, "{worst}");
    }
}
