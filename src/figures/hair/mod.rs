//! Hair of head and face as strands, grown from a seed.
//!
//! ```text
//! roots on the skin (roots.rs) -> guide strands that follow the style and stay outside of head and torso
//!   (style.rs, growth.rs) -> strands between the guides, in clumps (growth.rs)
//! ```
//!
//! Real heads have some 100 000 hairs of 0.07 mm; ours have fewer and thicker ones that cover as much.

mod face_hair;
mod growth;
mod hair_body;
mod head_surface;
mod obstacles;
mod roots;
mod style;
mod torso_surface;

pub use face_hair::brow_density;
pub use hair_body::HairBody;
pub use style::{beard_density, begins_sparse, scalp_density};

use crate::scene::{Figure, StrandPoint, Strands};
use rayon::prelude::*;

/// Every so many strands of hair and beard are drawn in the live view.
const THINNING: usize = 5;
/// Factor on the radius of those strands. Strands hide each other, so that it is less than [`THINNING`].
const THICKENING: f32 = 2.6;
/// Points of a strand in the live view, or half of its points if those are more: curls need them.
const COARSE_POINTS: usize = 8;
/// Number of strands that a thread makes at a time.
const STRANDS_OF_A_GROUP: usize = 512;

/// Returns the strand of each item with its index, made in parallel: in the order of the items, in groups.
fn in_parallel<T: Sync, P: IntoIterator<Item = StrandPoint>>(
    items: &[T],
    strand: impl Fn(usize, &T) -> P + Sync,
) -> Vec<Strands> {
    let group = |(number, items): (usize, &[T])| {
        let mut group = Strands::default();
        let indices = number * STRANDS_OF_A_GROUP..;
        indices.zip(items).for_each(|(index, item)| group.push(strand(index, item)));
        group
    };
    // One group at a time: the other threads are busy with the skin when the hair begins, and help later
    items.par_chunks(STRANDS_OF_A_GROUP).enumerate().with_max_len(1).map(group).collect()
}

/// Returns fewer and thicker strands with fewer points, for the live view.
pub fn thinned(strands: &Strands) -> Strands {
    let mut coarse = Strands::default();
    for part in strands.parts() {
        let is_dense = part.name == "hair" || part.name == "beard";
        let (every, factor) = if is_dense { (THINNING, THICKENING) } else { (2, 2.0) };
        let kept: Vec<u32> = part.strands.clone().step_by(every).collect();
        coarse.append_all(&in_parallel(&kept, |_, &strand| {
            let points = strands.strand(strand as usize);
            let last = points.len() - 1;
            let count = points.len().min(COARSE_POINTS.max(points.len() / 2));
            let kept = (0..count).map(move |k| points[k * last / (count - 1)]);
            kept.map(move |p| StrandPoint { radius_m: p.radius_m * factor, ..p })
        }));
        coarse.end_part(&part.name);
    }
    coarse
}

/// Returns the hair of a figure's head, in groups.
pub fn grow_on_head(body: &HairBody, figure: &Figure) -> Vec<Strands> {
    style::of_head(figure.hair).map_or_else(Vec::new, |style| growth::grow_head(body, figure, &style))
}

/// Returns the hair of a figure's face: parts `beard`, `brows` and `lashes`.
pub fn grow_on_face(body: &HairBody, figure: &Figure) -> Strands {
    let mut strands = Strands::default();
    if let Some(style) = style::of_beard(figure.beard) {
        face_hair::grow_beard(body, figure, &style, &mut strands);
    }
    strands.end_part("beard");
    face_hair::grow_brows(body, figure, &mut strands);
    strands.end_part("brows");
    face_hair::grow_lashes(body, figure, &mut strands);
    strands.end_part("lashes");
    strands
}

#[cfg(test)]
mod tests {
    use crate::figures::{READY, build, head_frame};
    use crate::scene::{Beard, Figure, HairStyle, Pose};
    use glam::Vec3;

    #[test]
    fn hair_grows_on_every_ready_figure_and_the_live_view_has_a_fifth_of_it() {
        for ready in [&READY[0], &READY[1], &READY[5]] {
            let figure = ready.figure();
            let meshes = build(&figure);
            let parts = |strands: &crate::scene::Strands| -> Vec<(String, usize)> {
                strands.parts().iter().map(|p| (p.name.clone(), p.strands.len())).collect()
            };
            let (fine, coarse) = (parts(&meshes.fine.strands), parts(&meshes.coarse.strands));
            assert!(fine.iter().any(|(part, count)| part == "hair" && *count > 20_000), "{}: {fine:?}", ready.name);
            assert!(fine.iter().any(|(part, count)| part == "brows" && *count > 800), "{}: {fine:?}", ready.name);
            assert!(fine.iter().any(|(part, count)| part == "lashes" && *count > 200), "{}: {fine:?}", ready.name);
            for ((part, all), (_, some)) in fine.iter().zip(&coarse) {
                let share = *some as f32 / *all as f32;
                assert!(share < if part == "hair" || part == "beard" { 0.21 } else { 0.51 }, "{part}: {share}");
            }
            // All hair lies round the head and shoulders of a standing person.
            let height = figure.body.height_m;
            let (low, high) = meshes.fine.strands.bounds().unwrap();
            assert!(low.y > 0.5 * height && high.y < height + 0.06, "{low} {high}");
            assert_eq!(build(&figure).fine, meshes.fine, "equal parameters make equal meshes");
        }
    }

    #[test]
    fn upper_lids_have_more_and_longer_lashes_than_lower_ones() {
        for ready in &READY {
            let figure = Figure { pose: Pose::default(), ..ready.figure() };
            let to_head = head_frame(&figure).inverse();
            let lashes = build(&figure).fine.strands.with_parts(|part| part == "lashes");
            let lash = |index: usize| {
                let points = lashes.strand(index);
                let [root, end] = [points[0], points[points.len() - 1]].map(|p| to_head.transform_point3(p.position));
                end - root
            };
            let (upper, lower): (Vec<_>, Vec<_>) = (0..lashes.len()).map(lash).partition(|lash| lash.y > 0.0);
            let mean = |lashes: &[Vec3]| lashes.iter().map(|lash| lash.length()).sum::<f32>() / lashes.len() as f32;
            let counts = [upper.len(), lower.len()];
            assert!(counts[0] > 2 * counts[1] && counts[1] > 60, "{}: {counts:?}", ready.name);
            assert!(mean(&upper) > 1.5 * mean(&lower), "{}: {} {}", ready.name, mean(&upper), mean(&lower));
        }
    }

    #[test]
    fn hair_bends_in_curves() {
        // One in ten strands of long hair had a corner: where it came to the neck, the clothes or the forehead, and where
        // its wave turned over. One in fifty of tied hair had one at the tie.
        const CORNER_DEG: f32 = 75.0;
        // A crop is some millimetres long
        let is_long = |figure: &Figure| figure.hair != HairStyle::Crop;
        for (ready, figure) in READY.iter().map(|ready| (ready, ready.figure())).filter(|(_, f)| is_long(f)) {
            let strands = build(&figure).fine.strands.with_parts(|part| part == "hair");
            let has_corner = |index: usize| {
                let points: Vec<Vec3> = strands.strand(index).iter().map(|point| point.position).collect();
                let bend = |p: &[Vec3]| (p[1] - p[0]).angle_between(p[2] - p[1]).to_degrees();
                // At its root hair turns from the skin
                points.windows(3).skip(2).any(|p| bend(p) > CORNER_DEG)
            };
            let corners = (0..strands.len()).filter(|&index| has_corner(index)).count();
            assert!(corners * 1000 < strands.len(), "{}: {corners} of {} strands", ready.name, strands.len());
        }
    }

    #[test]
    fn hair_stays_the_same_when_a_figure_turns_its_head() {
        // Roots were placed by the area of the figure's skin: the least change put each of them elsewhere, in the median
        // by 94 mm.
        let roots_of = |figure: &Figure| {
            let to_head = head_frame(figure).inverse();
            let strands = build(figure).fine.strands.with_parts(|part| part == "hair");
            let root = |index: usize| to_head.transform_point3(strands.strand(index)[0].position);
            (0..strands.len()).map(root).collect::<Vec<_>>()
        };
        for ready in [&READY[0], &READY[1], &READY[2]] {
            let figure = Figure { pose: Pose::default(), ..ready.figure() };
            let mut turned = figure;
            turned.pose.torso.head_yaw_deg = 30.0;
            let (before, after) = (roots_of(&figure), roots_of(&turned));
            // The skin of the nape follows the neck
            let moved = before.iter().zip(&after).filter(|(a, b)| a.distance(**b) > 0.02).count();
            assert!(moved * 100 < before.len(), "{}: {moved} of {} roots", ready.name, before.len());
        }
    }

    #[test]
    fn long_hair_falls_over_the_clothes() {
        const DEPTH_M: f32 = 0.002;
        let meshes = build(&READY[0].figure());
        let mesh = &*meshes.fine;
        let top = mesh.parts.iter().find(|part| part.name == "top").unwrap();
        let triangles = &mesh.triangles[top.triangles.start as usize..top.triangles.end as usize];
        let cloth: std::collections::BTreeSet<u32> = triangles.iter().flatten().copied().collect();
        let (mut over, mut inside) = (0, 0);
        for index in (0..mesh.strands.len()).step_by(60) {
            let low = mesh.strands.strand(index).iter().filter(|point| point.position.y < 1.4);
            for point in low.map(|point| point.position) {
                let squared = |v: u32| mesh.positions[v as usize].distance_squared(point);
                let nearest =
                    cloth.iter().copied().min_by(|a, b| squared(*a).total_cmp(&squared(*b))).unwrap() as usize;
                let height = (point - mesh.positions[nearest]).dot(mesh.normals[nearest]);
                over += usize::from(height > 0.0);
                inside += usize::from(height < -DEPTH_M);
            }
        }
        assert!(over > 500 && inside * 50 < over, "{over} points over the clothes, {inside} inside");
    }

    #[test]
    fn a_bob_is_cut_at_one_level() {
        let figure = Figure { hair: HairStyle::Bob, ..READY[0].figure() };
        let strands = build(&figure).fine.strands.with_parts(|part| part == "hair");
        let to_head = head_frame(&figure).inverse();
        let ends: Vec<f32> = (0..strands.len())
            .map(|index| strands.strand(index).iter().map(|p| to_head.transform_point3(p.position).y))
            .map(|heights| heights.fold(f32::INFINITY, f32::min))
            .collect();
        assert!(ends.iter().all(|&end| end > -0.15), "one ends at {:?}", ends.iter().copied().reduce(f32::min));
        let at_level = ends.iter().filter(|end| (-0.15..-0.12).contains(*end)).count();
        assert!(at_level * 5 > strands.len() * 3, "{at_level} of {} reach the level", strands.len());
    }

    #[test]
    fn short_hair_has_sideburns_and_leaves_the_face_free() {
        for (hair, has_sideburns) in [(HairStyle::Short, true), (HairStyle::Crop, true), (HairStyle::TiedBack, false)] {
            let figure = Figure { hair, ..READY[1].figure() };
            let strands = build(&figure).fine.strands.with_parts(|part| part == "hair");
            let to_head = head_frame(&figure).inverse();
            let points = |index: usize| strands.strand(index).iter().map(|p| to_head.transform_point3(p.position));
            let is_before_ears = |p: Vec3| p.z > -0.06;
            let is_sideburn = |p: Vec3| is_before_ears(p) && (-0.025..0.0).contains(&p.y);
            let sideburns = (0..strands.len()).filter(|&index| points(index).next().is_some_and(is_sideburn)).count();
            assert_eq!(sideburns > 20, has_sideburns, "{hair:?}: {sideburns} hairs");
            // Brows and jaw
            let is_on_face = |p: Vec3| is_before_ears(p) && (p.y < -0.04 || (p.x.abs() < 0.04 && p.y < 0.045));
            let on_face = (0..strands.len()).filter(|&index| points(index).any(is_on_face)).count();
            assert_eq!(on_face, 0, "{hair:?}");
        }
    }

    #[test]
    fn strands_that_cross_a_parting_do_not_gather_on_its_line() {
        // Those that crossed it were all moved to the plane of the parting.
        let figure = Figure { hair: HairStyle::Long, ..READY[0].figure() };
        let strands = build(&figure).fine.strands.with_parts(|part| part == "hair");
        let to_head = head_frame(&figure).inverse();
        let points = (0..strands.len()).flat_map(|index| &strands.strand(index)[1..]);
        let top: Vec<f32> = points
            .map(|p| to_head.transform_point3(p.position))
            .filter(|p| p.y > 0.08 && p.z > -0.04)
            .map(|p| p.x)
            .collect();
        // The parting is at 20 mm: compare the fullest tenth of a millimetre near it with the mean
        let near = |x: f32, half: f32| top.iter().filter(|other| (*other - x).abs() < half).count();
        let fullest = (-50..=50).map(|step| near(0.02 + step as f32 * 1e-4, 0.5e-4)).max().unwrap();
        let mean = near(0.02, 0.005) as f32 / 100.0;
        assert!(mean > 5.0 && (fullest as f32) < 5.0 * mean, "{fullest} in a tenth of a millimetre, {mean} on average");
    }

    #[test]
    fn a_parting_is_a_straight_line() {
        // Strands followed the nearest guide on either side: the line ran in a zigzag between the guides, a centimetre
        // wide. Those within some millimetres of it may cross.
        const PARTING_M: f32 = 0.025;
        const BESIDE_M: std::ops::Range<f32> = 0.007..0.012;
        let figure = Figure { hair: HairStyle::Bob, ..READY[0].figure() };
        let strands = build(&figure).fine.strands.with_parts(|part| part == "hair");
        let to_head = head_frame(&figure).inverse();
        // Root and middle of the strands on the front of the crown
        let ends = |index: usize| {
            let points = strands.strand(index);
            [0, points.len() / 2].map(|k| to_head.transform_point3(points[k].position))
        };
        let is_beside =
            |[root, _]: &[Vec3; 2]| root.y > 0.06 && root.z > -0.06 && BESIDE_M.contains(&(root.x - PARTING_M).abs());
        let beside: Vec<[Vec3; 2]> = (0..strands.len()).map(ends).filter(is_beside).collect();
        let crosses = |ends: &&[Vec3; 2]| (ends[0].x > PARTING_M) != (ends[1].x > PARTING_M);
        let crossing = beside.iter().filter(crosses).count();
        assert!(beside.len() > 500 && crossing * 100 < beside.len(), "{crossing} of {} cross", beside.len());
    }

    #[test]
    fn tied_hair_falls_as_one_tail() {
        // Nine tenths lay within 35 mm of its middle, in locks with gaps between them
        const LEVEL_M: f32 = -0.08;
        const RADIUS_M: f32 = 0.028;
        let figure = Figure { hair: HairStyle::TiedBack, ..READY[0].figure() };
        let strands = build(&figure).fine.strands.with_parts(|part| part == "hair");
        let to_head = head_frame(&figure).inverse();
        // Where the strands pass a level under the tie
        let passes = (0..strands.len()).filter_map(|index| {
            let points: Vec<Vec3> =
                strands.strand(index).iter().map(|point| to_head.transform_point3(point.position)).collect();
            let ends = points.windows(2).rfind(|ends| (ends[0].y > LEVEL_M) != (ends[1].y > LEVEL_M))?;
            Some(ends[0].lerp(ends[1], (LEVEL_M - ends[0].y) / (ends[1].y - ends[0].y)))
        });
        let passes: Vec<Vec3> = passes.collect();
        assert!(passes.len() * 10 > strands.len() * 9, "{} of {}", passes.len(), strands.len());
        let middle = passes.iter().sum::<Vec3>() / passes.len() as f32;
        let within = passes.iter().filter(|p| p.distance(middle) < RADIUS_M).count();
        assert!(within * 10 > passes.len() * 9, "{within} of {} lie within the tail", passes.len());
    }

    #[test]
    fn a_full_beard_is_short_on_the_cheeks() {
        let figure = Figure { beard: Beard::Full, ..READY[1].figure() };
        let strands = build(&figure).fine.strands.with_parts(|part| part == "beard");
        let to_head = head_frame(&figure).inverse();
        let (mut cheek, mut chin) = (Vec::new(), Vec::new());
        for index in 0..strands.len() {
            let points = strands.strand(index);
            let root = to_head.transform_point3(points[0].position);
            let length = points.windows(2).map(|ends| ends[0].position.distance(ends[1].position)).sum::<f32>();
            if root.y > -0.03 {
                cheek.push(length);
            } else if root.y < -0.105 && root.z > 0.0 {
                chin.push(length);
            }
        }
        assert!(cheek.len() > 100 && cheek.iter().all(|length| *length < 0.012), "{} hairs", cheek.len());
        let mean = chin.iter().sum::<f32>() / chin.len() as f32;
        assert!(mean > 0.02, "{mean} m at the chin");
    }

    #[test]
    fn hair_with_a_parting_falls_beside_the_face() {
        for style in [HairStyle::Bob, HairStyle::Long] {
            let figure = Figure { hair: style, ..READY[0].figure() };
            let strands = build(&figure).fine.strands.with_parts(|part| part == "hair");
            let to_head = head_frame(&figure).inverse();
            let is_before_face = |p: Vec3| p.x.abs() < 0.055 && (-0.1..0.02).contains(&p.y) && p.z > -0.02;
            let before: Vec<Vec<Vec3>> = (0..strands.len())
                .map(|index| strands.strand(index).iter().map(|p| to_head.transform_point3(p.position)).collect())
                .filter(|points: &Vec<Vec3>| points.iter().any(|p| is_before_face(*p)))
                .collect();
            assert!(before.is_empty(), "{style:?}: {} strands, for example {:?}", before.len(), before[0]);
        }
    }
}
