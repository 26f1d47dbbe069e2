//! Welds face corners with equal indices to shared vertices.

use super::lines::CornerIndices;
use super::mesh_index::to_index;
use std::collections::HashMap;
use std::collections::hash_map::Entry;

/// Ends a chain of vertices.
const NONE: u32 = u32::MAX;
/// Longest chain of vertices at a position that is searched in order; few positions have more.
const CHAIN_LIMIT: usize = 16;

/// Assigns a vertex to each distinct combination of indices, in the order of their first use.
#[derive(Debug)]
pub(super) struct VertexWelder {
    /// The indices of each vertex.
    pub vertices: Vec<CornerIndices>,
    /// First vertex of the current group at each position.
    first: Vec<u32>,
    /// Next vertex at the same position, for each vertex.
    next: Vec<u32>,
    /// Vertices of the current group beyond a position's first [`CHAIN_LIMIT`].
    beyond: HashMap<CornerIndices, u32>,
    /// First vertex of the current group.
    group: usize,
}

impl VertexWelder {
    /// Returns a welder for corners with position indices below `positions`.
    pub fn new(positions: usize) -> Self {
        let first = vec![NONE; positions];
        VertexWelder { vertices: Vec::new(), first, next: Vec::new(), beyond: HashMap::new(), group: 0 }
    }

    /// Begins a group, which shares no vertices with the groups before it.
    pub fn begin_group(&mut self) {
        for vertex in &self.vertices[self.group..] {
            self.first[vertex[0] as usize] = NONE;
        }
        self.beyond = HashMap::new();
        self.group = self.vertices.len();
    }

    /// Returns the vertex of a corner.
    pub fn vertex(&mut self, corner: CornerIndices) -> u32 {
        let new = to_index(self.vertices.len());
        let (mut at, mut last, mut length) = (self.first[corner[0] as usize], NONE, 0);
        while at != NONE {
            if self.vertices[at as usize] == corner {
                return at;
            }
            (at, last, length) = (self.next[at as usize], at, length + 1);
        }
        if last == NONE {
            self.first[corner[0] as usize] = new;
        } else if length < CHAIN_LIMIT {
            self.next[last as usize] = new;
        } else {
            match self.beyond.entry(corner) {
                Entry::Occupied(known) => return *known.get(),
                Entry::Vacant(place) => place.insert(new),
            };
        }
        self.vertices.push(corner);
        self.next.push(NONE);
        new
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_corners_of_a_group_share_a_vertex() {
        let mut welder = VertexWelder::new(2);
        for group in 0..2 {
            welder.begin_group();
            // Some positions with few combinations, one with many.
            let corner = |i: u32| if i.is_multiple_of(10) { [0, i % 7, 1] } else { [1, i, 2] };
            let first: Vec<u32> = (0..1000).map(|i| welder.vertex(corner(i))).collect();
            let again: Vec<u32> = (0..1000).map(|i| welder.vertex(corner(i))).collect();
            assert_eq!(first, again);
            let vertices = 900 + 7;
            assert_eq!(welder.vertices.len(), (group + 1) * vertices);
            assert!((0..1000).all(|i| welder.vertices[first[i as usize] as usize] == corner(i)));
        }
    }

    #[test]
    fn vertices_are_numbered_by_first_use() {
        let mut welder = VertexWelder::new(3);
        let corners = [[2, 0, 0], [0, 0, 0], [2, 0, 0], [2, 1, 0], [1, 0, 0]];
        assert_eq!(corners.map(|corner| welder.vertex(corner)), [0, 1, 0, 2, 3]);
    }
}
