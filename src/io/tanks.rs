//! The meshes of water tanks, simulated on first use.

use crate::scene::{Mesh, Tank};
use crate::water::{self, Simulation};
use std::sync::{Arc, LazyLock, Mutex, PoisonError};

/// Number of simulations and of meshes that are kept. A simulation takes six bytes a cell and 32 a column: at most
/// 14 MB.
const CAPACITY: usize = 4;

/// The last simulations and meshes, the latest last.
#[derive(Default)]
struct Cache {
    simulations: Vec<Simulation>,
    meshes: Vec<(Tank, Arc<Mesh>)>,
}

static CACHE: LazyLock<Mutex<Cache>> = LazyLock::new(Mutex::default);

/// Returns the mesh of a tank at its time. A simulation of an earlier time goes on from there.
pub(super) fn mesh(tank: &Tank) -> Arc<Mesh> {
    // A panic with the lock held leaves the lists intact: they change by whole entries
    let cache = || CACHE.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((_, mesh)) = cache().meshes.iter().find(|(known, _)| known == tank) {
        return mesh.clone();
    }
    let earlier = {
        let mut cache = cache();
        let found = cache.simulations.iter().rposition(|simulation| simulation.leads_to(tank));
        found.map(|index| cache.simulations.remove(index))
    };
    // Simulate without the lock, so that several tanks are simulated in parallel
    let mut simulation = earlier.unwrap_or_else(|| Simulation::new(tank));
    simulation.run_to(tank);
    let mesh = Arc::new(water::mesh(simulation.grid(), tank));
    let mut cache = cache();
    keep(&mut cache.simulations, simulation);
    keep(&mut cache.meshes, (tank.clone(), mesh.clone()));
    mesh
}

fn keep<T>(list: &mut Vec<T>, latest: T) {
    let excess = (list.len() + 1).saturating_sub(CAPACITY);
    list.drain(..excess);
    list.push(latest);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Spring;
    use glam::Vec3;

    #[test]
    fn a_tank_is_the_same_whatever_was_simulated_before() {
        let spring = Spring::new(Vec3::new(0.0, 0.3, 0.0), 0.5);
        let at = |time_s| Tank { cells: [16, 32, 16], springs: vec![spring.clone()], time_s, ..Tank::default() };
        let direct = |time_s| {
            let mut simulation = Simulation::new(&at(time_s));
            simulation.run_to(&at(time_s));
            water::mesh(simulation.grid(), &at(time_s))
        };
        for time_s in [0.5, 1.0, 0.25, 1.0] {
            assert_eq!(*mesh(&at(time_s)), direct(time_s), "{time_s} s");
        }
        assert!(Arc::ptr_eq(&mesh(&at(1.0)), &mesh(&at(1.0))));
        (0..20).for_each(|i| drop(mesh(&Tank { cells: [2, 2, 2], water_m: 0.001 * i as f32, ..Tank::default() })));
        let cache = CACHE.lock().unwrap();
        assert!(cache.simulations.len() <= CAPACITY && cache.meshes.len() <= CAPACITY);
    }
}
