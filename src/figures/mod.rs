//! Builds the shipped figures, a woman, a man, a child and a portrait bust, from body measures and poses.
//!
//! ```text
//! Build (measures) + PoseAngles -> Skeleton -> groups of primitives (head, trunk, limbs) = one signed distance field
//!   -> surface nets -> isotropic remeshing -> Mesh with the parts skin, eyes, iris, pupil, clothes
//! ```
//!
//! The body is one distance field, so the skin is one closed surface. The head follows mean adult landmarks, since the
//! light patterns of a portrait depend on them: brow, sockets and lids, bridge, tip and wings of the nose, cheekbones,
//! lips, chin and jaw. The result is a function of measures and pose: the same bits for any number of threads.

mod culled_field;
mod extremities;
mod eyes;
mod face;
mod field;
mod figure;
mod garment;
mod head;
mod limbs;
mod meshing;
mod obj;
mod pose;
mod primitive;
mod proportions;
mod remesh;
mod skeleton;
#[cfg(test)]
mod tests;
mod torso;

pub use figure::{Detail, Extent, Sculpture};
pub use obj::to_obj;
pub use pose::{ArmPose, LegPose, PoseAngles, Turn};
pub use proportions::{Build, FaceShape};

use crate::scene::{Figure, Mannequin, Material, MaterialPreset, Mesh, Pose};
use glam::Vec3;
use std::io;
use std::path::Path;

/// Every shipped figure, in list order.
pub const ALL: [Mannequin; 14] = [
    Mannequin { figure: Figure::Woman, pose: Pose::Standing },
    Mannequin { figure: Figure::Woman, pose: Pose::Contrapposto },
    Mannequin { figure: Figure::Woman, pose: Pose::Seated },
    Mannequin { figure: Figure::Woman, pose: Pose::HeadTurned },
    Mannequin { figure: Figure::Man, pose: Pose::Standing },
    Mannequin { figure: Figure::Man, pose: Pose::Contrapposto },
    Mannequin { figure: Figure::Man, pose: Pose::Seated },
    Mannequin { figure: Figure::Man, pose: Pose::HeadTurned },
    Mannequin { figure: Figure::Child, pose: Pose::Standing },
    Mannequin { figure: Figure::Child, pose: Pose::Contrapposto },
    Mannequin { figure: Figure::Child, pose: Pose::Seated },
    Mannequin { figure: Figure::Child, pose: Pose::HeadTurned },
    Mannequin { figure: Figure::Bust, pose: Pose::Standing },
    Mannequin { figure: Figure::Bust, pose: Pose::HeadTurned },
];

/// Returns the figure of [`ALL`] for a figure: a bust has neither hips nor seat, so it is upright in those poses.
pub fn resolve(mannequin: Mannequin) -> Mannequin {
    match mannequin {
        Mannequin { figure: Figure::Bust, pose: Pose::Contrapposto | Pose::Seated } => {
            Mannequin { figure: Figure::Bust, pose: Pose::Standing }
        }
        other => other,
    }
}

/// Builds the mesh of a figure in full detail, with smooth normals. Takes seconds; the shipped files hold the result.
pub fn build(mannequin: Mannequin) -> Mesh {
    let mut mesh = sculpture(mannequin).mesh(Detail::FULL);
    mesh.compute_smooth_normals();
    mesh
}

/// Returns the middle of the face in object space, metres: between the eyes and the tip of the nose.
pub fn face_point(mannequin: Mannequin) -> Vec3 {
    sculpture(mannequin).face_point()
}

/// Returns the unit vector in object space in which the face looks.
pub fn face_direction(mannequin: Mannequin) -> Vec3 {
    sculpture(mannequin).head().transform_vector3(Vec3::Z).normalize_or(Vec3::Z)
}

/// Returns the name of the shipped file: `woman_standing.obj`.
pub fn file_name(mannequin: Mannequin) -> String {
    let mannequin = resolve(mannequin);
    let figure = match mannequin.figure {
        Figure::Woman => "woman",
        Figure::Man => "man",
        Figure::Child => "child",
        Figure::Bust => "bust",
    };
    let pose = match mannequin.pose {
        Pose::Standing => "standing",
        Pose::Contrapposto => "contrapposto",
        Pose::Seated => "seated",
        Pose::HeadTurned => "head_turned",
    };
    format!("{figure}_{pose}.obj")
}

/// Returns the materials of the parts that are not skin: eyes, iris, pupil and the suit of whole figures. A dark
/// `skin`, the object's own material, gets darker eyes.
pub fn default_parts(skin: &Material) -> Vec<(String, Material)> {
    let gloss = |base_color| Material { base_color, ..MaterialPreset::Eye.material() };
    let [r, g, b] = skin.base_color;
    let light = 0.2126 * r + 0.7152 * g + 0.0722 * b;
    let iris = if light > 0.35 { [0.11, 0.085, 0.05] } else { [0.06, 0.03, 0.015] };
    vec![
        ("eyes".to_owned(), MaterialPreset::Eye.material()),
        ("iris".to_owned(), gloss(iris)),
        ("pupil".to_owned(), gloss([0.005; 3])),
        ("clothes".to_owned(), MaterialPreset::MatteFabric.material()),
    ]
}

/// Builds every figure of [`ALL`] and writes it as an OBJ file into a folder, which is created if need be. Returns the
/// files' names.
///
/// # Errors
/// If the folder or a file can't be written.
pub fn bake(dir: &Path) -> io::Result<Vec<String>> {
    std::fs::create_dir_all(dir)?;
    let mut names = Vec::new();
    for mannequin in ALL {
        let name = file_name(mannequin);
        std::fs::write(dir.join(&name), to_obj(&build(mannequin)))?;
        names.push(name);
    }
    Ok(names)
}

fn sculpture(mannequin: Mannequin) -> Sculpture {
    let mannequin = resolve(mannequin);
    let extent = if mannequin.figure == Figure::Bust { Extent::Bust } else { Extent::Whole };
    Sculpture::new(Build::of(mannequin.figure), &PoseAngles::of(mannequin.figure, mannequin.pose), extent)
}
