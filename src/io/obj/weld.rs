//! From corners that name a position, a texture coordinate and a normal each to vertices that have all three.

use super::lines::Corner;
use std::collections::HashMap;
use std::collections::hash_map::Entry;

/// No vertex.
const NONE: u32 = u32::MAX;
/// Vertices at a position that are looked through one by one; few have more.
const CHAIN: usize = 16;

/// Makes each combination a vertex, in the order in which they come.
#[derive(Debug)]
pub(super) struct Welder {
    /// All vertices so far.
    pub vertices: Vec<Corner>,
    /// First vertex of the group at each position.
    first: Vec<u32>,
    /// The next vertex at the same position, for each vertex.
    next: Vec<u32>,
    /// Vertices beyond a position's first [`CHAIN`].
    beyond: HashMap<Corner, u32>,
    /// Where the group's vertices begin.
    group: usize,
}

impl Welder {
    /// For corners that name so many positions.
    pub fn new(positions: usize) -> Self {
        let first = vec![NONE; positions];
        Welder { vertices: Vec::new(), first, next: Vec::new(), beyond: HashMap::new(), group: 0 }
    }

    /// Begins a group: it shares no vertices with those before it.
    pub fn begin_group(&mut self) {
        for vertex in &self.vertices[self.group..] {
            self.first[vertex[0] as usize] = NONE;
        }
        self.beyond = HashMap::new();
        self.group = self.vertices.len();
    }

    /// The corner's vertex.
    pub fn vertex(&mut self, corner: Corner) -> u32 {
        let new = self.vertices.len() as u32;
        let (mut at, mut last, mut length) = (self.first[corner[0] as usize], NONE, 0);
        while at != NONE {
            if self.vertices[at as usize] == corner {
                return at;
            }
            (at, last, length) = (self.next[at as usize], at, length + 1);
        }
        if last == NONE {
            self.first[corner[0] as usize] = new;
        } else if length < CHAIN {
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
    fn equal_corners_of_a_group_are_one_vertex_however_many_there_are() {
        let mut welder = Welder::new(2);
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
    fn vertices_are_numbered_as_they_come() {
        let mut welder = Welder::new(3);
        let corners = [[2, 0, 0], [0, 0, 0], [2, 0, 0], [2, 1, 0], [1, 0, 0]];
        assert_eq!(corners.map(|corner| welder.vertex(corner)), [0, 1, 0, 2, 3]);
    }
}
