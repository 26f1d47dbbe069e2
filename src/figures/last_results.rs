//! The last results of a computation for figures, kept for the next time.

use crate::scene::Figure;
use std::sync::{Mutex, PoisonError};

/// The results for the figures that were asked for last.
#[derive(Debug)]
pub struct LastResults<T> {
    capacity: usize,
    /// The latest last.
    results: Mutex<Vec<(Figure, T)>>,
}

impl<T: Clone> LastResults<T> {
    /// Returns no results, with room for those of so many figures.
    pub const fn new(capacity: usize) -> Self {
        LastResults { capacity, results: Mutex::new(Vec::new()) }
    }

    /// Returns the result for a figure, computed if it is not among the last ones. Figures are computed in parallel.
    pub fn get_or(&self, figure: &Figure, compute: impl FnOnce() -> T) -> T {
        // A panic with the lock held leaves the list intact: it changes by whole entries.
        let results = || self.results.lock().unwrap_or_else(PoisonError::into_inner);
        let known = results().iter().find(|(known, _)| known == figure).map(|(_, result)| result.clone());
        let result = known.unwrap_or_else(compute);
        let mut results = results();
        results.retain(|(known, _)| known != figure);
        let excess = (results.len() + 1).saturating_sub(self.capacity);
        results.drain(..excess);
        results.push((*figure, result.clone()));
        result
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_results_are_kept_and_older_ones_are_computed_again() {
        let results = LastResults::new(2);
        let figure = |seed| Figure { seed, ..Figure::default() };
        let mut computed = Vec::new();
        for seed in [1, 2, 1, 3, 1, 2] {
            let result = results.get_or(&figure(seed), || {
                computed.push(seed);
                10 * seed
            });
            assert_eq!(result, 10 * seed);
        }
        assert_eq!(computed, [1, 2, 3, 2], "1 was asked for again before 3 came");
    }
}
