//! Figures: meshes of people from their parameters.
//!
//! ```text
//! BodyData (base mesh, targets, bones) + Figure -> morph: rest positions -> skeleton and skinning: posed positions
//!   -> cages of skin and teeth, garments draped as cloth and their bands -> Catmull-Clark subdivision
//!   -> Mesh with parts; eyes and their tear lines
//! ```
//!
//! Hair of the head and clothes are those of the face without expression, and are kept while it changes.
//!
//! The body data are MakeHuman's (CC0), converted by `catchlight bake-figures`. A mesh is a function of the parameters:
//! the same bits for any number of threads.

mod bands;
mod body_codec;
mod body_data;
mod build;
mod cloth;
mod cut;
mod eyes;
mod face;
mod fairing;
mod garments;
mod gaze;
mod hair;
mod iris;
mod joints;
mod last_results;
mod makehuman;
mod materials;
mod morph;
mod named_expressions;
mod named_poses;
mod patch;
mod posed_body;
mod random;
mod ready;
mod regions;
mod skeleton;
mod skin_colors;
mod skin_textures;
mod skinning;
mod subdivide;
mod tear_line;
mod two_bone_ik;

pub use body_codec::BodyDataError;
pub use body_data::BodyData;
pub use eyes::Cornea;
pub use gaze::{as_variant, follow_gazes, gaze_falls_short, show_variant};
pub use joints::{Joint, PosableBody};
pub use makehuman::read_body;
pub use materials::{
    CLOTH_COLORS, ClothColor, EYE_COLORS, EyeColor, HAIR_COLORS, SKIN_TONES, SkinTone, default_parts, give_cloth_color,
    give_eyes, give_hair, give_skin, iris_textures,
};
pub use named_expressions::NamedExpression;
pub use named_poses::NamedPose;
pub use ready::{READY, ReadyFigure, randomised};
pub use skeleton::Side;
pub use skin_textures::{builtin_texture, skin_textures};

use crate::scene::{Figure, FigureMeshes};
pub use build::{PARTS, build};
use glam::{Affine3A, Vec3};
use last_results::LastResults;
use posed_body::PosedBody;

/// Returns the meshes of a figure from those of another one, if the two differ in the gaze alone; see [`build()`].
pub fn build_from(built: &Figure, meshes: &FigureMeshes, figure: &Figure) -> Option<FigureMeshes> {
    let same = gaze::without_gaze(built) == gaze::without_gaze(figure);
    same.then(|| build::with_other_gaze(meshes, figure))
}

/// Returns the middle of the face in object space, metres: between the eyes and the tip of the nose.
pub fn face_point(figure: &Figure) -> Vec3 {
    head_frame(figure).transform_point3(FACE_FROM_EYES * (figure.body.height_m / 1.7))
}

/// Returns the point between the pupils in object space, metres.
pub fn eye_point(figure: &Figure) -> Vec3 {
    head_frame(figure).transform_point3(Vec3::Z * eyes::BALL_M)
}

/// Returns the corneas of a figure's left and right eye in object space, metres.
pub fn corneas(figure: &Figure) -> [Cornea; 2] {
    let data = BodyData::shipped();
    PosedBody::new(data, figure).eyeballs(data, figure).map(Cornea::new)
}

/// Returns the unit vector in object space in which the face looks.
pub fn face_direction(figure: &Figure) -> Vec3 {
    head_frame(figure).transform_vector3(Vec3::Z).normalize_or(Vec3::Z)
}

/// The middle of the face from the point between the eyeballs' middles, for a height of 1.7 m, metres.
const FACE_FROM_EYES: Vec3 = Vec3::new(0.0, -0.018, 0.02);

/// Returns object from head of a figure, without a scale: origin between the eyeballs' middles, +X to the figure's left,
/// +Y up, +Z the direction of the face. The last ones are kept: the window asks each frame, and a body takes some
/// milliseconds to pose.
pub fn head_frame(figure: &Figure) -> Affine3A {
    static LAST: LastResults<Affine3A> = LastResults::new(16);
    let figure = &gaze::without_gaze(figure);
    let data = BodyData::shipped();
    LAST.get_or(figure, || PosedBody::new(data, figure).head(data))
}
