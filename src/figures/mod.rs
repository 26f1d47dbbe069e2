//! The figures of the wardrobe: a woman, a man, a child and a portrait bust, made from measures and a pose.
//!
//! ```text
//! Build (measures) + PoseAngles -> skeleton -> groups of shapes (head, trunk, limbs) = one signed distance field
//!   -> surface nets -> even triangles on the surface -> Mesh with the parts skin, eyes, iris, pupil, clothes
//! ```
//!
//! The field is one, so the skin is one closed surface. The head is modelled after mean adult landmarks, because a
//! face is what a portrait light is judged by: brow, sockets and lids, bridge, tip and wings of the nose, cheekbones,
//! lips, chin and jaw all stand where the light patterns need them. The result depends on nothing but the
//! measures: any number of threads gives the same bits.

mod cubes;
mod extremities;
mod eyes;
mod face;
mod field;
mod figure;
mod garment;
mod head;
mod limbs;
mod obj;
mod pose;
mod proportions;
mod remesh;
mod shape;
mod skeleton;
mod surface;
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

/// Every figure that is baked, in list order.
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

/// The figure of [`ALL`] that stands for this one: a bust has neither hips nor seat, so those poses leave it upright.
pub fn resolve(mannequin: Mannequin) -> Mannequin {
    match mannequin {
        Mannequin { figure: Figure::Bust, pose: Pose::Contrapposto | Pose::Seated } => {
            Mannequin { figure: Figure::Bust, pose: Pose::Standing }
        }
        other => other,
    }
}

/// Makes a figure in full detail, with smooth normals. Takes seconds: the baked files hold the same.
pub fn build(mannequin: Mannequin) -> Mesh {
    let mut mesh = sculpture(mannequin).mesh(Detail::FULL);
    mesh.compute_smooth_normals();
    mesh
}

/// The middle of the face in object space, between the eyes and the tip of the nose.
pub fn face_point(mannequin: Mannequin) -> Vec3 {
    sculpture(mannequin).face_point()
}

/// Unit vector, in object space, in which the face looks.
pub fn face_direction(mannequin: Mannequin) -> Vec3 {
    sculpture(mannequin).head().transform_vector3(Vec3::Z).normalize_or(Vec3::Z)
}

/// Name of the baked file: `woman_standing.obj`.
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

/// Surfaces of the parts that are not skin: eyes, iris, pupil and the suit that whole figures wear. `skin` is the object's own material; it is taken so
/// that a dark skin gets dark eyes.
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

/// Makes every figure of [`ALL`] and writes it into a folder, which is made if need be. Returns the files' names.
///
/// # Errors
/// What the file system says.
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
