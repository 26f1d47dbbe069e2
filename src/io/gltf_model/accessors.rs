//! Checks of the arrays of a primitive, before they are read.

use super::buffers::ModelFile;
use gltf::accessor::{DataType, Dimensions};
use gltf::{Accessor, Primitive, Semantic};

/// Kinds of components that an array may have.
const FLOAT: &[DataType] = &[DataType::F32];
const FLOAT_OR_NORMALIZED: &[DataType] = &[DataType::F32, DataType::U8, DataType::U16];
const UNSIGNED: &[DataType] = &[DataType::U8, DataType::U16];
const INDEX: &[DataType] = &[DataType::U8, DataType::U16, DataType::U32];

/// Checks every array of a primitive that is read: its kind, and that it lies inside its buffer.
///
/// # Errors
/// If one has another kind than the format asks for, no elements, or reaches beyond its buffer.
pub fn check(file: &ModelFile, primitive: &Primitive<'_>) -> Result<(), String> {
    for (semantic, accessor) in primitive.attributes() {
        let (dimensions, kinds): (&[Dimensions], _) = match semantic {
            Semantic::Positions | Semantic::Normals => (&[Dimensions::Vec3], FLOAT),
            Semantic::TexCoords(_) => (&[Dimensions::Vec2], FLOAT_OR_NORMALIZED),
            Semantic::Colors(_) => (&[Dimensions::Vec3, Dimensions::Vec4], FLOAT_OR_NORMALIZED),
            Semantic::Joints(_) => (&[Dimensions::Vec4], UNSIGNED),
            Semantic::Weights(_) => (&[Dimensions::Vec4], FLOAT_OR_NORMALIZED),
            Semantic::Tangents | Semantic::Extras(_) => continue,
        };
        check_array(file, &accessor, dimensions, kinds)?;
    }
    for target in primitive.morph_targets() {
        for accessor in [target.positions(), target.normals()].into_iter().flatten() {
            check_array(file, &accessor, &[Dimensions::Vec3], FLOAT)?;
        }
    }
    primitive.indices().map_or(Ok(()), |indices| check_array(file, &indices, &[Dimensions::Scalar], INDEX))
}

/// Checks the matrices of a skin, as [`check`].
///
/// # Errors
/// As [`check`].
pub fn check_matrices(file: &ModelFile, accessor: &Accessor<'_>) -> Result<(), String> {
    check_array(file, accessor, &[Dimensions::Mat4], FLOAT)
}

fn check_array(
    file: &ModelFile,
    accessor: &Accessor<'_>,
    dimensions: &[Dimensions],
    kinds: &[DataType],
) -> Result<(), String> {
    let wrong = |what: &str| Err(format!("its array {} {what}", accessor.index()));
    if !dimensions.contains(&accessor.dimensions()) || !kinds.contains(&accessor.data_type()) {
        return wrong("has the wrong kind of numbers");
    }
    let Some(view) = accessor.view().filter(|_| accessor.sparse().is_none()) else {
        return wrong("has sparse values, which are not read");
    };
    let size = accessor.size();
    let stride = view.stride().unwrap_or(size);
    let last = accessor.count().checked_sub(1).and_then(|steps| steps.checked_mul(stride));
    let end = last.and_then(|last| last.checked_add(accessor.offset())?.checked_add(size));
    let has_room = file.view(&view).is_some_and(|bytes| end.is_some_and(|end| end <= bytes.len()));
    if stride < size || !has_room { wrong("reaches beyond its data") } else { Ok(()) }
}
