//! The staggered grid (Harlow and Welch 1965): velocities across the faces between cells.

use glam::Vec3;
use rayon::prelude::*;

/// A value for the faces across each axis.
pub(super) type Faces = [Vec<f32>; 3];

/// Where the values of cells and of faces are in memory. Face (x, y, z) across an axis is the lower one of that cell.
///
/// The values of cells are columns along Y, then rows along X, then planes along Z. Those of faces have one more along
/// each axis, and a plane before the first one, so that slabs of planes can be written in parallel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Layout {
    size: [usize; 3],
}

/// The eight faces around a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stencil {
    /// The first of them.
    pub base: usize,
    /// The point between them, 0 to 1.
    pub t: Vec3,
    /// Its coordinates from the first of them.
    pub first: Vec3,
}

impl Layout {
    pub(super) fn new(size: [usize; 3]) -> Self {
        Layout { size }
    }

    pub(super) fn size(&self) -> [usize; 3] {
        self.size
    }

    pub(super) fn cell_count(&self) -> usize {
        self.size.iter().product()
    }

    pub(super) fn cell(&self, [x, y, z]: [usize; 3]) -> usize {
        (z * self.size[0] + x) * self.size[1] + y
    }

    /// Returns the cell of a point; the nearest one for a point outside.
    pub(super) fn cell_at(&self, at: Vec3) -> usize {
        let side = |axis: usize| (at[axis].max(0.0) as usize).min(self.size[axis] - 1);
        self.cell([side(0), side(1), side(2)])
    }

    pub(super) fn cell_stride(&self, axis: usize) -> usize {
        [self.size[1], 1, self.size[0] * self.size[1]][axis]
    }

    pub(super) fn for_each_cell(&self, mut call: impl FnMut([usize; 3], usize)) {
        let mut cell = 0;
        for z in 0..self.size[2] {
            for x in 0..self.size[0] {
                for y in 0..self.size[1] {
                    call([x, y, z], cell);
                    cell += 1;
                }
            }
        }
    }

    /// Returns the number of faces in a plane across Z.
    pub(super) fn plane(&self) -> usize {
        (self.size[0] + 1) * (self.size[1] + 1)
    }

    pub(super) fn face_count(&self) -> usize {
        self.plane() * (self.size[2] + 2)
    }

    pub(super) fn face(&self, [x, y, z]: [usize; 3]) -> usize {
        ((z + 1) * (self.size[0] + 1) + x) * (self.size[1] + 1) + y
    }

    pub(super) fn face_stride(&self, axis: usize) -> usize {
        [self.size[1] + 1, 1, self.plane()][axis]
    }

    /// Returns zero for all faces.
    pub(super) fn faces(&self) -> Faces {
        [(); 3].map(|()| vec![0.0; self.face_count()])
    }

    /// Returns the faces across an axis that are around a point.
    #[inline]
    pub(super) fn stencil(&self, at: Vec3, axis: usize) -> Stencil {
        let mut low = [0; 3];
        let mut t = Vec3::ZERO;
        let mut first = Vec3::ZERO;
        for k in 0..3 {
            let (offset, last) = if k == axis { (0.0, self.size[k]) } else { (0.5, self.size[k] - 1) };
            let from = (at[k] - offset).clamp(0.0, last as f32);
            low[k] = (from as usize).min(last.saturating_sub(1));
            t[k] = from - low[k] as f32;
            first[k] = at[k] - offset - low[k] as f32;
        }
        Stencil { base: self.face(low), t, first }
    }

    /// Returns the offset of each face of a stencil in memory.
    pub(super) fn stencil_offsets(&self) -> [usize; 8] {
        let [x, y, z] = [0, 1, 2].map(|axis| self.face_stride(axis));
        std::array::from_fn(|i| (i & 1) * x + (i >> 1 & 1) * y + (i >> 2) * z)
    }

    /// Returns the velocity at a point.
    pub(super) fn velocity(&self, faces: &Faces, offsets: &[usize; 8], at: Vec3) -> Vec3 {
        let mut velocity = Vec3::ZERO;
        for axis in 0..3 {
            let stencil = self.stencil(at, axis);
            let weights = stencil.weights();
            velocity[axis] = (0..8).map(|i| weights[i] * faces[axis][stencil.base + offsets[i]]).sum();
        }
        velocity
    }

    /// Continues values from valid faces to those around them, by some layers. Walls keep theirs.
    pub(super) fn extrapolate(
        &self,
        faces: &mut Faces,
        valid: &mut [Vec<bool>; 3],
        walls: &[Vec<bool>; 3],
        layers: usize,
    ) {
        faces.par_iter_mut().zip(valid.par_iter_mut()).enumerate().for_each(|(axis, (values, valid))| {
            let mut border: Vec<usize> = (0..valid.len()).filter(|&face| valid[face]).collect();
            let mut is_met = vec![false; valid.len()];
            for _ in 0..layers {
                let mut front: Vec<(usize, f32)> = Vec::new();
                for other in border.iter().flat_map(|&face| self.around(axis, face)).flatten() {
                    if valid[other] || walls[axis][other] || std::mem::replace(&mut is_met[other], true) {
                        continue;
                    }
                    let around = self.around(axis, other).into_iter().flatten().filter(|&face| valid[face]);
                    let (sum, count) = around.fold((0.0, 0.0), |(sum, count), face| (sum + values[face], count + 1.0));
                    front.push((other, sum / count));
                }
                for &(face, value) in &front {
                    (values[face], valid[face]) = (value, true);
                }
                border = front.into_iter().map(|(face, _)| face).collect();
            }
        });
    }

    /// Returns the faces across an axis that are next to one, but for those of the sides.
    fn around(&self, axis: usize, face: usize) -> [Option<usize>; 6] {
        let (rows, plane) = (self.size[1] + 1, self.plane());
        let at = [face / rows % (self.size[0] + 1), face % rows, (face / plane).saturating_sub(1)];
        std::array::from_fn(|i| {
            let (k, stride) = (i / 2, self.face_stride(i / 2));
            let first = usize::from(k == axis);
            if i % 2 == 0 {
                (at[k] > first).then(|| face - stride)
            } else {
                (at[k] + 1 < self.size[k]).then(|| face + stride)
            }
        })
    }
}

impl Stencil {
    /// Returns the weights of linear interpolation.
    #[inline]
    pub(super) fn weights(&self) -> [f32; 8] {
        let [x, y, z] = self.t.to_array().map(|t| [1.0 - t, t]);
        std::array::from_fn(|i| x[i & 1] * y[i >> 1 & 1] * z[i >> 2])
    }

    /// Returns the gradient of each weight.
    #[inline]
    pub(super) fn gradients(&self) -> [Vec3; 8] {
        let [x, y, z] = self.t.to_array().map(|t| [1.0 - t, t]);
        const SIGN: [f32; 2] = [-1.0, 1.0];
        std::array::from_fn(|i| {
            let (a, b, c) = (i & 1, i >> 1 & 1, i >> 2);
            Vec3::new(SIGN[a] * y[b] * z[c], x[a] * SIGN[b] * z[c], x[a] * y[b] * SIGN[c])
        })
    }

    /// Returns the vector from the point to each face.
    #[inline]
    pub(super) fn towards(&self, i: usize) -> Vec3 {
        Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) - self.first
    }
}
