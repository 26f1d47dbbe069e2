//! What must hold for every figure: closed, even, upright, of the stated size, the same every time.

use super::*;
use std::collections::{BTreeMap, HashMap};
use std::sync::{Mutex, OnceLock};

/// Returns a mesh that is coarse enough to make all figures in a test.
fn made_coarse(mannequin: Mannequin) -> Mesh {
    let mut mesh = sculpture(mannequin).mesh(Detail::new(2.5));
    mesh.compute_smooth_normals();
    mesh
}

/// Returns the coarse mesh of a figure, which is made once for all tests.
fn coarse(mannequin: Mannequin) -> &'static Mesh {
    static MESHES: Mutex<BTreeMap<String, &'static OnceLock<Mesh>>> = Mutex::new(BTreeMap::new());
    let mesh = *MESHES.lock().unwrap().entry(file_name(mannequin)).or_insert_with(|| Box::leak(Box::default()));
    mesh.get_or_init(|| made_coarse(mannequin))
}

fn part_names(mannequin: Mannequin) -> &'static [&'static str] {
    match mannequin.figure {
        Figure::Bust => &["skin", "eyes", "iris", "pupil"],
        _ => &["skin", "eyes", "iris", "pupil", "clothes"],
    }
}

fn part<'a>(mesh: &'a Mesh, name: &str) -> &'a [[u32; 3]] {
    let part = mesh.parts.iter().find(|p| p.name == name).unwrap();
    &mesh.triangles[part.triangles.start as usize..part.triangles.end as usize]
}

/// Every edge belongs to two triangles that run along it in opposite directions, and every vertex to one fan.
fn assert_closed(triangles: &[[u32; 3]], what: &str) {
    let mut next = HashMap::new();
    let mut fans: HashMap<u32, Vec<(u32, u32)>> = HashMap::new();
    for t in triangles {
        for k in 0..3 {
            let (a, b, c) = (t[k], t[(k + 1) % 3], t[(k + 2) % 3]);
            assert!(next.insert((a, b), c).is_none(), "{what}: edge {a}-{b} runs twice the same way");
            fans.entry(a).or_default().push((b, c));
        }
    }
    assert!(next.keys().all(|&(a, b)| next.contains_key(&(b, a))), "{what}: an edge is open");
    for (vertex, spokes) in fans {
        let ring: HashMap<u32, u32> = spokes.iter().copied().collect();
        let (mut at, mut steps) = (spokes[0].0, 0);
        while steps == 0 || at != spokes[0].0 {
            at = ring[&at];
            steps += 1;
        }
        assert_eq!(steps, spokes.len(), "{what}: vertex {vertex} joins two sheets");
    }
}

/// Returns the number of connected components of a mesh.
fn pieces(triangles: &[[u32; 3]]) -> usize {
    let mut parent: HashMap<u32, u32> = triangles.iter().flatten().map(|&v| (v, v)).collect();
    fn root(parent: &mut HashMap<u32, u32>, mut v: u32) -> u32 {
        while parent[&v] != v {
            let up = parent[&parent[&v]];
            parent.insert(v, up);
            v = up;
        }
        v
    }
    let mut pieces = parent.len();
    for t in triangles {
        for (a, b) in [(t[0], t[1]), (t[1], t[2])] {
            let (a, b) = (root(&mut parent, a), root(&mut parent, b));
            if a != b {
                parent.insert(a, b);
                pieces -= 1;
            }
        }
    }
    pieces
}

fn volume(mesh: &Mesh, triangles: &[[u32; 3]]) -> f32 {
    triangles.iter().map(|t| t.map(|i| mesh.positions[i as usize])).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
}

fn height(mesh: &Mesh) -> f32 {
    let (low, high) = mesh.bounds();
    high.y - low.y
}

#[test]
fn every_figure_is_a_closed_solid_without_slivers() {
    for mannequin in ALL {
        let name = file_name(mannequin);
        let mesh = coarse(mannequin);
        assert_eq!(mesh.parts.iter().map(|p| p.name.as_str()).collect::<Vec<_>>(), part_names(mannequin));
        for &part_name in part_names(mannequin) {
            let triangles = part(mesh, part_name);
            assert_closed(triangles, &format!("{name} {part_name}"));
            let wanted = if ["skin", "clothes"].contains(&part_name) { 1 } else { 2 };
            assert_eq!(pieces(triangles), wanted, "{name} {part_name}");
            assert!(volume(mesh, triangles) > 0.0, "{name} {part_name} is inside out");
        }
        // A body weighs about what water does: litres are kilograms.
        let litres = 1000.0 * volume(mesh, part(mesh, "skin"));
        let range = match mannequin.figure {
            Figure::Woman => 42.0..75.0,
            Figure::Man => 58.0..95.0,
            Figure::Child => 18.0..36.0,
            Figure::Bust => 8.0..25.0,
        };
        assert!(range.contains(&litres), "{name}: {litres} litres");
        for i in 0..mesh.triangles.len() {
            let [a, b, c] = mesh.corners(i);
            let area = (b - a).cross(c - a).length();
            let longest = (b - a).length().max((c - b).length()).max((a - c).length());
            assert!(area > 0.01 * longest * longest, "{name}: triangle {i} is a sliver");
        }
        assert!(mesh.bounds().0.y.abs() < 0.003, "{name} does not stand on the floor: {}", mesh.bounds().0.y);
    }
}

#[test]
fn figures_have_their_height_and_their_head_fits_it() {
    for (figure, stated, heads) in [(Figure::Woman, 1.68, 7.5), (Figure::Man, 1.80, 7.5), (Figure::Child, 1.28, 6.0)] {
        let mannequin = Mannequin { figure, pose: Pose::Standing };
        let mesh = coarse(mannequin);
        assert!((height(mesh) - stated).abs() < 0.01 * stated, "{figure:?}: {}", height(mesh));
        // The chin: the lowest point of the skin well before the neck.
        let face = face_point(mannequin);
        let chin = mesh
            .positions
            .iter()
            .filter(|p| p.x.abs() < 0.01 && p.z > face.z - 0.035 && (p.y - face.y).abs() < 0.2 * stated / heads * 6.0)
            .filter(|p| p.y > face.y - 0.7 * stated / heads)
            .map(|p| p.y)
            .fold(f32::INFINITY, f32::min);
        let ratio = stated / (mesh.bounds().1.y - chin);
        assert!((ratio - heads).abs() < 0.05 * heads, "{figure:?} is {ratio} heads high");
    }
}

#[test]
fn standing_is_the_same_left_and_right() {
    let mesh = coarse(ALL[0]);
    // The mesh need not mirror vertex by vertex, but the solid does: every vertex's mirror image is on the surface.
    let grid: HashMap<[i32; 3], ()> =
        mesh.positions.iter().map(|p| ((*p / 0.03).round().as_ivec3().to_array(), ())).collect();
    let lonely = mesh.positions.iter().filter(|p| {
        let [x, y, z] = (**p * Vec3::new(-1.0, 1.0, 1.0) / 0.03).round().as_ivec3().to_array();
        !(-1..=1).any(|dx| (-1..=1).any(|dy| (-1..=1).any(|dz| grid.contains_key(&[x + dx, y + dy, z + dz]))))
    });
    assert_eq!(lonely.count(), 0);
    let (low, high) = mesh.bounds();
    assert!((low.x + high.x).abs() < 0.004, "{low} {high}");
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| made_coarse(Mannequin { figure: Figure::Bust, pose: Pose::HeadTurned }))
    };
    assert!(on(1) == on(2));
}

#[test]
fn the_baked_bust_is_closed_and_what_the_sculptor_makes_today() {
    let mannequin = Mannequin { figure: Figure::Bust, pose: Pose::Standing };
    let baked = include_str!("../../assets/mannequins/bust_standing.obj");
    let mesh = build(mannequin);
    assert_closed(part(&mesh, "skin"), "bust");
    for (i, t) in mesh.triangles.iter().enumerate() {
        let [a, b, c] = mesh.corners(i);
        let face = (b - a).cross(c - a).normalize();
        let sum: Vec3 = t.iter().map(|&v| mesh.normals[v as usize]).sum();
        assert!(sum.dot(face) > 0.0, "the normals of triangle {i} disagree with its winding");
    }
    assert!((30_000..120_000).contains(&mesh.triangles.len()), "{} triangles", mesh.triangles.len());
    assert!(
        to_obj(&mesh) == baked,
        "assets/mannequins is stale: run `catchlight bake-mannequins -o assets/mannequins`"
    );
}

#[test]
fn every_pair_names_a_baked_file_that_tobj_reads_as_its_parts() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/mannequins");
    for figure in [Figure::Woman, Figure::Man, Figure::Child, Figure::Bust] {
        for pose in [Pose::Standing, Pose::Contrapposto, Pose::Seated, Pose::HeadTurned] {
            let mannequin = Mannequin { figure, pose };
            assert!(ALL.contains(&resolve(mannequin)));
            let path = folder.join(file_name(mannequin));
            let (models, _) = tobj::load_obj(&path, &tobj::LoadOptions::default()).unwrap();
            assert_eq!(models.iter().map(|m| m.name.as_str()).collect::<Vec<_>>(), part_names(mannequin));
            let triangles: usize = models.iter().map(|m| m.mesh.indices.len() / 3).sum();
            assert!((30_000..120_000).contains(&triangles), "{}: {triangles} triangles", path.display());
            assert!(path.metadata().unwrap().len() < 4_000_000, "{}", path.display());
        }
    }
}

#[test]
fn a_turned_head_looks_to_its_own_left() {
    let straight = Mannequin { figure: Figure::Woman, pose: Pose::Standing };
    let turned = Mannequin { pose: Pose::HeadTurned, ..straight };
    assert!((face_direction(straight) - Vec3::Z).length() < 1e-5);
    let angle = face_direction(turned).x.asin().to_degrees();
    assert!((angle - 30.0).abs() < 0.5, "{angle}");
    // The face lies on the skin: within a centimetre of a vertex.
    let mesh = coarse(turned);
    let nearest = mesh.positions.iter().map(|p| (*p - face_point(turned)).length()).fold(f32::INFINITY, f32::min);
    assert!(nearest < 0.01, "{nearest}");
}

#[test]
fn a_bust_has_a_flat_base() {
    let mesh = coarse(Mannequin { figure: Figure::Bust, pose: Pose::Standing });
    assert!((0.45..0.62).contains(&height(mesh)), "{}", height(mesh));
    assert!(mesh.positions.iter().filter(|p| p.y < 0.001).count() > 10);
}
