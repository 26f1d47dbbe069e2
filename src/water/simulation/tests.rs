//! Conservation, symmetry, determinism and rest of the automaton.

use super::*;
use crate::scene::{Block, CellContent, Terrain};
use glam::Vec3;

fn tank(cells: [u16; 3], terrain: Terrain) -> Tank {
    Tank { cells, cell_m: 0.1, terrain, water_m: 0.0, ..Tank::default() }
}

/// Returns a tank with a block of water over uneven ground, and no spring.
fn dam(cells: [u16; 3]) -> Tank {
    let to = [cells[0] / 3, cells[1] - 1, cells[2] / 2];
    let hills = Terrain::Hills { seed: 3, low_m: 0.05, high_m: 0.35, period_m: 0.5 };
    let water = Block { from: [0, 2, 0], to, content: CellContent::Water };
    let cave = Block { from: [2, 0, 2], to: [4, 1, 6], content: CellContent::Air };
    let post = Block { from: [5, 0, 5], to: [5, 9, 5], content: CellContent::Metal };
    Tank { blocks: vec![water, cave, post], ..tank(cells, hills) }
}

/// Runs to rest; returns the number of steps.
fn rest(simulation: &mut Simulation) -> u32 {
    let steps = (0..100_000).find(|_| {
        simulation.advance();
        simulation.is_at_rest()
    });
    steps.expect("water comes to rest")
}

/// Returns the height of the water over each column that has some, in units from the underside.
fn levels(grid: &Grid) -> Vec<Option<u64>> {
    let ny = grid.size()[1];
    let level = |column: usize| {
        let top = (0..ny).rev().find(|layer| grid.water(column * ny + layer) > 2000)?;
        Some(top as u64 * u64::from(FULL) + u64::from(grid.level(column * ny + top)))
    };
    (0..grid.columns()).map(level).collect()
}

#[test]
fn no_unit_is_lost_or_made_and_no_cell_overflows() {
    let mut simulation = Simulation::new(&dam([13, 12, 9]));
    let volume = simulation.grid().volume();
    assert!(volume > 100 * u64::from(FULL));
    for step in 0..400 {
        simulation.advance();
        assert_eq!(simulation.grid().volume(), volume, "step {step}");
    }
    let cells = 0..13 * 12 * 9;
    assert!(cells.clone().all(|cell| simulation.grid().level(cell) <= FULL));
    assert!(cells.filter(|&cell| simulation.grid().is_metal(cell)).all(|cell| simulation.grid().water(cell) == 0));
}

#[test]
fn water_comes_to_rest_level() {
    let mut simulation = Simulation::new(&dam([12, 12, 8]));
    rest(&mut simulation);
    let levels: Vec<u64> = levels(simulation.grid()).into_iter().flatten().collect();
    let (low, high) = (levels.iter().min().unwrap(), levels.iter().max().unwrap());
    assert!(levels.len() > 60, "a lake of {} columns", levels.len());
    // Neighbours differ by less than five units; the lake is 20 columns from corner to corner
    assert!(high - low <= 4 * 20, "{low} to {high} of {FULL} a cell");
    let volume = simulation.grid().volume();
    simulation.advance();
    assert!(simulation.is_at_rest() && simulation.grid().volume() == volume);
}

#[test]
fn a_symmetric_basin_stays_symmetric() {
    for cells in [[11, 10, 11], [10, 10, 10]] {
        let side = usize::from(cells[0]);
        let basin = tank(cells, Terrain::Basin { floor_m: 0.1, rim_m: 0.7 });
        let middle = [cells[0] / 2 - 1, 6, cells[2] / 2 - 1];
        let to = [cells[0] - 1 - middle[0], 9, cells[2] - 1 - middle[2]];
        let block = Block { from: middle, to, content: CellContent::Water };
        let mut simulation = Simulation::new(&Tank { blocks: vec![block], ..basin });
        for _ in 0..100 {
            simulation.advance();
            let grid = simulation.grid();
            let at = |x: usize, y: usize, z: usize| grid.water(grid.index([x, y, z]));
            for (x, y, z) in (0..side).flat_map(|x| (0..10).flat_map(move |y| (0..side).map(move |z| (x, y, z)))) {
                assert_eq!(at(x, y, z), at(side - 1 - x, y, z), "mirrored in x");
                assert_eq!(at(x, y, z), at(x, y, side - 1 - z), "mirrored in z");
                assert_eq!(at(x, y, z), at(z, y, x), "turned by 90 degrees");
            }
        }
        assert!(simulation.grid().volume() > 0);
    }
}

#[test]
fn the_state_is_the_same_for_any_number_of_threads() {
    let spring = Spring { at_m: Vec3::new(0.3, 1.0, 0.5), litres_per_s: 20.0, switches_s: vec![0.0, 0.5, 0.7] };
    let tank = Tank { springs: vec![spring], time_s: 1.0, ..dam([30, 12, 40]) };
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut simulation = Simulation::new(&tank);
            simulation.run_to(&tank);
            simulation.grid().clone()
        })
    };
    let one = run(1);
    assert!(one == run(3) && one == run(7));
}

#[test]
fn a_spring_adds_exactly_its_flow_and_nothing_while_it_is_off() {
    // In the ground, in the air, and in the top layer
    for height_m in [0.05, 0.6, 0.99] {
        let spring = Spring { at_m: Vec3::new(0.0, height_m, 0.0), litres_per_s: 1.7, switches_s: vec![0.0, 2.0, 3.0] };
        let mut tank = tank([8, 10, 8], Terrain::Flat { height_m: 0.32 });
        tank.springs.push(spring);
        let mut simulation = Simulation::new(&tank);
        let mut volume_at = |time_s: f32| {
            simulation.run_to(&Tank { time_s, ..tank.clone() });
            assert_eq!(simulation.grid().volume(), simulation.poured());
            // A cell of 10 cm is one litre
            simulation.poured() as f64 / f64::from(FULL)
        };
        assert!((volume_at(2.0) - 3.4).abs() < 1e-4, "spring at {height_m}");
        assert_eq!(volume_at(2.5), volume_at(3.0), "off");
        assert!((volume_at(4.0) - 5.1).abs() < 1e-4);
    }
}

#[test]
fn extremes_neither_fail_nor_change_the_volume() {
    let all = |cells: [u16; 3], content| Tank {
        blocks: vec![Block { from: [0; 3], to: cells.map(|side| side - 1), content }],
        springs: vec![Spring::new(Vec3::new(0.0, 0.01, 0.0), 1e6)],
        ..tank(cells, Terrain::Flat { height_m: 0.0 })
    };
    for (content, volume) in
        [(CellContent::Water, 24), (CellContent::Ground, 0), (CellContent::Metal, 0), (CellContent::Air, 24)]
    {
        let tank = Tank { time_s: 1.0, ..all([2, 4, 3], content) };
        let mut simulation = Simulation::new(&tank);
        simulation.run_to(&tank);
        // Nothing has room in full or solid tanks; the spring fills the others to the brim, but for the last units
        let missing = (volume * u64::from(FULL)).checked_sub(simulation.grid().volume());
        assert!(missing.is_some_and(|units| units < 24 * 4), "{content:?}: {missing:?}");
    }
    let single = Tank { time_s: 120.0, ..all([1, 1, 1], CellContent::Air) };
    let mut simulation = Simulation::new(&single);
    simulation.run_to(&single);
    assert_eq!(simulation.grid().volume(), u64::from(FULL));
}

#[test]
fn a_simulation_goes_on_where_it_was_and_knows_when_it_cannot() {
    let spring = Spring::new(Vec3::new(0.0, 0.6, 0.0), 5.0);
    let at = |time_s| Tank { springs: vec![spring.clone()], time_s, ..dam([9, 12, 9]) };
    let mut stepwise = Simulation::new(&at(0.0));
    for time_s in [0.1, 0.4, 1.0] {
        assert!(stepwise.leads_to(&at(time_s)));
        stepwise.run_to(&at(time_s));
    }
    let mut direct = Simulation::new(&at(1.0));
    direct.run_to(&at(1.0));
    assert_eq!(stepwise.grid(), direct.grid());
    assert!(!direct.leads_to(&at(0.9)), "not back in time");
    // Switched off now or later it is the same so far; switched off earlier it is not
    let mut switched = at(2.0);
    assert!(switched.springs[0].switch(1.0) && direct.leads_to(&switched));
    assert!(switched.springs[0].switch(0.5) && !direct.leads_to(&switched));
    assert!(!direct.leads_to(&Tank { water_m: 0.3, ..at(2.0) }));
    assert!(direct.leads_to(&Tank { look: TankLook::Cubes, ..at(2.0) }), "the look is not part of the water");
}

#[test]
fn a_tank_at_rest_waits_for_its_spring_at_no_cost() {
    let spring = Spring { at_m: Vec3::new(0.0, 0.05, 0.0), litres_per_s: 1.0, switches_s: vec![119.5] };
    let mut tank = tank([64, 4, 64], Terrain::Flat { height_m: 0.0 });
    (tank.springs, tank.time_s) = (vec![spring], 120.0);
    let mut simulation = Simulation::new(&tank);
    simulation.run_to(&tank);
    assert!((simulation.poured() as f64 / f64::from(FULL) - 0.5).abs() < 1e-4);
}

#[test]
fn the_largest_tank_takes_six_bytes_a_cell_and_sixteen_a_column() {
    let tank = tank([128, 128, 128], Terrain::Flat { height_m: 0.5 });
    assert_eq!(tank.cell_count(), Tank::MAX_CELLS);
    let mut simulation = Simulation::new(&tank);
    simulation.advance();
    let Simulation { grid, spans, next, next_spans, .. } = &simulation;
    let spans = size_of_val(&spans[..]) + size_of_val(&next_spans[..]);
    assert_eq!(grid.bytes() + size_of_val(&next[..]), 6 * Tank::MAX_CELLS);
    assert_eq!(spans, 16 * 128 * 128);
}
