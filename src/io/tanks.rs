//! The meshes of water tanks, simulated on first use.

use crate::scene::{Mesh, Tank, Texture};
use crate::water::{self, FluidSimulation, Simulation};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::{Arc, LazyLock, Mutex, PoisonError};

/// Number of simulations and of meshes that are kept. A simulation takes six bytes a cell and 16 a column: at most
/// 14 MB.
const CAPACITY: usize = 4;
/// Number of fluids that are kept. One takes 60 bytes a particle and 12 a cell: at most 75 MB.
const FLUIDS: usize = 2;

/// The last simulations and meshes, the latest last, with the hash of the picture of the ground.
#[derive(Default)]
struct Cache {
    simulations: Vec<(u64, Simulation)>,
    fluids: Vec<(u64, FluidSimulation)>,
    meshes: Vec<(u64, Tank, Arc<Mesh>)>,
}

static CACHE: LazyLock<Mutex<Cache>> = LazyLock::new(Mutex::default);

/// Returns the mesh of a tank at its time, of which `heights` is the picture of the ground. A simulation of an earlier
/// time goes on from there.
pub(super) fn mesh(tank: &Tank, heights: Option<&Texture>) -> Arc<Mesh> {
    let hash = heights.map_or(0, content_hash);
    // A panic with the lock held leaves the lists intact: they change by whole entries
    let cache = || CACHE.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((.., mesh)) = cache().meshes.iter().find(|(known_hash, known, _)| *known_hash == hash && known == tank)
    {
        return mesh.clone();
    }
    // Simulate without the lock, so that several tanks are simulated in parallel
    let mesh = if tank.fluid.is_some() {
        let earlier = take(&mut cache().fluids, |(known, fluid)| *known == hash && fluid.leads_to(tank));
        let mut fluid = earlier.map_or_else(|| FluidSimulation::new(tank, heights), |(_, fluid)| fluid);
        fluid.run_to(tank);
        let mesh = Arc::new(water::fluid_mesh(&fluid, tank));
        keep(&mut cache().fluids, (hash, fluid), FLUIDS);
        mesh
    } else {
        let leads = |(known, simulation): &(u64, Simulation)| *known == hash && simulation.leads_to(tank);
        let earlier = take(&mut cache().simulations, leads);
        let mut simulation =
            earlier.map_or_else(|| Simulation::with_heights(tank, heights), |(_, simulation)| simulation);
        simulation.run_to(tank);
        let mesh = Arc::new(water::mesh(simulation.grid(), tank));
        keep(&mut cache().simulations, (hash, simulation), CAPACITY);
        mesh
    };
    keep(&mut cache().meshes, (hash, tank.clone(), mesh.clone()), CAPACITY);
    mesh
}

/// Takes the latest entry that fits out of a list.
fn take<T>(list: &mut Vec<T>, fits: impl Fn(&T) -> bool) -> Option<T> {
    list.iter().rposition(fits).map(|index| list.remove(index))
}

fn content_hash(picture: &Texture) -> u64 {
    let mut hasher = DefaultHasher::new();
    (picture.width, picture.height, &picture.rgb).hash(&mut hasher);
    hasher.finish()
}

fn keep<T>(list: &mut Vec<T>, latest: T, capacity: usize) {
    let excess = (list.len() + 1).saturating_sub(capacity);
    list.drain(..excess);
    list.push(latest);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Block, CellContent, Spring};
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
        let block = Block { from: [0, 2, 0], to: [3, 7, 7], content: CellContent::Water };
        for time_s in [0.5, 1.0, 0.25, 1.0] {
            assert_eq!(*mesh(&at(time_s), None), direct(time_s), "{time_s} s");
        }
        assert!(Arc::ptr_eq(&mesh(&at(1.0), None), &mesh(&at(1.0), None)));
        let fluid = Some(Box::new(crate::scene::Fluid::default()));
        let splash = |time_s| Tank { cells: [8, 8, 8], blocks: vec![block], fluid: fluid.clone(), ..at(time_s) };
        for time_s in [0.02, 0.05, 0.01] {
            let mut direct = FluidSimulation::new(&splash(time_s), None);
            direct.run_to(&splash(time_s));
            assert_eq!(*mesh(&splash(time_s), None), water::fluid_mesh(&direct, &splash(time_s)), "{time_s} s");
        }
        let small = |i: u32| Tank { cells: [2, 2, 2], water_m: 0.001 * i as f32, ..Tank::default() };
        (0..20).for_each(|i| drop(mesh(&small(i), None)));
        // The picture of the ground is another file, or was changed
        let terrain = crate::scene::Terrain::Picture { path: "a.png".to_owned(), low_m: 0.0, high_m: 0.3 };
        let tank = Tank { cells: [8, 8, 8], cell_m: 0.05, terrain, water_m: 0.0, ..Tank::default() };
        let of = |value: u8| mesh(&tank, Some(&Texture::opaque(1, 1, vec![[value; 3]]))).bounds().1.y;
        assert!(of(20) < of(90) && of(20) < of(90));
        let cache = CACHE.lock().unwrap();
        assert!(cache.simulations.len() <= CAPACITY && cache.meshes.len() <= CAPACITY);
        assert!(cache.fluids.len() <= FLUIDS);
    }
}
