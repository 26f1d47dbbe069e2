//! Conservation, rest, symmetry, determinism, free fall, and the collapse of a column against its published front.

use super::*;
use crate::scene::{Block, CellContent, Drop, Jet, Obstacle, ObstacleForm, Terrain};

/// A tank of air with a fluid, of cells of 5 mm.
fn tank(cells: [u16; 3], fluid: Fluid) -> Tank {
    let terrain = Terrain::Flat { height_m: 0.0 };
    Tank { cells, cell_m: 0.005, terrain, water_m: 0.0, fluid: Some(Box::new(fluid)), ..Tank::default() }
}

/// A tank with a block of still water that fills its columns up to a layer, along some of X.
fn column(cells: [u16; 3], width: u16, layers: u16) -> Tank {
    let block = Block { from: [0; 3], to: [width - 1, layers - 1, cells[2] - 1], content: CellContent::Water };
    Tank { blocks: vec![block], ..tank(cells, Fluid::default()) }
}

fn at(tank: &Tank, time_s: f32) -> FluidSimulation {
    let mut simulation = FluidSimulation::new(tank, None);
    simulation.run_to(&Tank { time_s, ..tank.clone() });
    simulation
}

/// Returns the mean velocity, m/s, and the mean energy, J/kg, of the particles.
fn motion(simulation: &FluidSimulation) -> (Vec3, f32) {
    let cell_m = simulation.recipe.cell_m;
    let count = simulation.particles.len() as f32;
    let velocity: Vec3 = simulation.particles.iter().map(|particle| particle.velocity).sum();
    let energy = |particle: &Particle| {
        0.5 * (particle.velocity * cell_m).length_squared() + GRAVITY_M_S2 * particle.at.y * cell_m
    };
    (velocity / count * cell_m, simulation.particles.iter().map(energy).sum::<f32>() / count)
}

#[test]
fn a_column_collapses_as_fast_as_that_of_martin_and_moyce() {
    // Martin and Moyce 1952, "An Experimental Study of the Collapse of Liquid Columns on a Rigid Horizontal Plane",
    // table 2: a column twice as high as wide, the front Z = x / a at T = t sqrt(2 g / a)
    let measured = [(1.19, 1.44), (1.63, 1.89), (1.98, 2.33), (2.51, 3.0), (2.98, 3.67)];
    let width = 8;
    let tank = Tank { cell_m: 0.02, ..column([40, 18, 2], width, 2 * width) };
    let width_m = f32::from(width) * tank.cell_m;
    let mut simulation = FluidSimulation::new(&tank, None);
    for (t, z) in measured {
        let time_s = t / (2.0 * GRAVITY_M_S2 / width_m).sqrt();
        simulation.run_to(&Tank { time_s, ..tank.clone() });
        let front = simulation.particles.iter().map(|particle| particle.at.x).fold(0.0, f32::max) + 0.25;
        let found = front / f32::from(width);
        // Eight cells are coarse, and the walls have no friction, which makes the front fast
        assert!((found / z - 1.0).abs() < 0.13, "front {found} for {z} at {t}");
    }
}

#[test]
fn still_water_stays_at_rest_and_a_wave_loses_its_energy() {
    let still = Tank { water_m: 0.03, ..tank([8, 10, 8], Fluid { seed: 1, ..Fluid::default() }) };
    let (velocity, energy) = motion(&at(&still, 0.0));
    let (later_velocity, later_energy) = motion(&at(&still, 0.3));
    assert!(velocity == Vec3::ZERO && later_velocity.length() < 2e-3, "{later_velocity}");
    assert!((later_energy / energy - 1.0).abs() < 0.01, "{later_energy} for {energy}");
    let wave = column([8, 9, 2], 3, 8);
    let mut simulation = FluidSimulation::new(&wave, None);
    let count = simulation.particles.len();
    assert_eq!(count, 3 * 8 * 2 * Fluid::PARTICLES_PER_CELL);
    let mut last = motion(&simulation).1;
    for second in 1..=3 {
        simulation.run_to(&Tank { time_s: second as f32, ..wave.clone() });
        let energy = motion(&simulation).1;
        // Particles that come too close to each other are driven apart, which lifts the water by some of a cell
        assert!(energy < 1.03 * last, "{energy} after {last}");
        last = last.min(energy);
        assert_eq!(simulation.particles.len(), count, "mass");
    }
    let speed = simulation.particles.iter().map(|p| p.velocity.length_squared()).sum::<f32>() / count as f32;
    assert!(speed.sqrt() * wave.cell_m < 0.03, "{} m/s after three seconds", speed.sqrt() * wave.cell_m);
    // The water is level, and takes the volume that it took: 3 cells of each column
    let top = |x: f32| {
        let in_column = simulation.particles.iter().filter(|particle| (particle.at.x - x).abs() < 1.0);
        in_column.map(|particle| particle.at.y).fold(0.0, f32::max)
    };
    for x in [1.0, 3.0, 5.0, 7.0] {
        assert!((top(x) - 3.0).abs() < 1.2, "{} cells at {x}", top(x));
    }
}

#[test]
fn a_drop_falls_freely_and_keeps_its_momentum() {
    let drop = Drop { at_m: Vec3::new(0.0, 0.09, 0.0), radius_m: 0.014, velocity_m_s: Vec3::new(0.3, 0.0, -0.2) };
    let tank = tank([24, 22, 18], Fluid { drops: vec![drop], ..Fluid::default() });
    let middle = |simulation: &FluidSimulation| {
        let sum: Vec3 = simulation.particles.iter().map(|particle| particle.at).sum();
        sum / simulation.particles.len() as f32 * tank.cell_m
    };
    let (start, end) = (at(&tank, 0.0), at(&tank, 0.1));
    let moved = middle(&end) - middle(&start);
    // Steps end with the velocity that they have reached: by half of a step too far
    let expected = Vec3::new(0.03, -0.5 * GRAVITY_M_S2 * 0.01, -0.02);
    assert!((moved - expected).length() < 0.0025, "{moved} for {expected}");
    let (velocity, _) = motion(&end);
    let expected = Vec3::new(0.3, -GRAVITY_M_S2 * 0.1, -0.2);
    assert!((velocity - expected).length() < 0.01, "{velocity} for {expected}");
    // It is still a ball
    let spread = end.particles.iter().map(|p| (p.at * tank.cell_m - middle(&end)).length()).fold(0.0, f32::max);
    assert!((spread - 0.014).abs() < 0.003, "{spread}");
}

#[test]
fn a_symmetric_splash_stays_symmetric() {
    let drop = Drop { at_m: Vec3::new(0.0, 0.06, 0.0), radius_m: 0.011, velocity_m_s: Vec3::NEG_Y };
    let tank = Tank { water_m: 0.02, ..tank([16, 16, 16], Fluid { drops: vec![drop], ..Fluid::default() }) };
    let simulation = at(&tank, 0.05);
    let count = simulation.particles.len() as f32;
    let mean = |value: fn(Vec3) -> f32| simulation.particles.iter().map(|p| value(p.at - 8.0)).sum::<f32>() / count;
    // Sums in another order round otherwise, which the splash amplifies
    assert!(mean(|at| at.x).abs() < 1e-3 && mean(|at| at.z).abs() < 1e-3, "the middle");
    let (wide, deep) = (mean(|at| at.x.abs()), mean(|at| at.z.abs()));
    assert!((wide - deep).abs() < 5e-3, "{wide} and {deep} cells");
    let (velocity, _) = motion(&simulation);
    assert!(velocity.x.abs() < 3e-3 && velocity.z.abs() < 3e-3, "{velocity}");
}

#[test]
fn the_state_is_the_same_for_any_number_of_threads_and_on_any_way_to_it() {
    let drop = Drop { at_m: Vec3::new(0.01, 0.05, 0.0), radius_m: 0.01, velocity_m_s: Vec3::NEG_Y };
    let jet = Jet { at_m: Vec3::new(-0.02, 0.06, 0.02), radius_m: 0.006, velocity_m_s: Vec3::NEG_Y, until_s: 0.02 };
    let form = ObstacleForm::Ball { radius_m: 0.008 };
    let obstacle = Obstacle { form, at_m: Vec3::new(0.0, 0.01, -0.02), falls_m_s: 1.0, stands_s: 0.02 };
    let fluid = Fluid { drops: vec![drop], jets: vec![jet], obstacles: vec![obstacle], seed: 4 };
    let tank = Tank { water_m: 0.02, ..tank([13, 14, 19], fluid) };
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| at(&tank, 0.03)).particles
    };
    let one = with(1);
    assert_eq!(one, with(3));
    assert_eq!(one, with(7));
    let mut stepwise = FluidSimulation::new(&tank, None);
    for time_s in [0.01, 0.02, 0.03] {
        let later = Tank { time_s, ..tank.clone() };
        assert!(stepwise.leads_to(&later));
        stepwise.run_to(&later);
    }
    assert_eq!(one, stepwise.particles);
    assert!(!stepwise.leads_to(&Tank { time_s: 0.01, ..tank.clone() }), "not back in time");
    assert!(!stepwise.leads_to(&Tank { time_s: 0.04, fluid: None, ..tank.clone() }));
}

#[test]
fn a_jet_pours_its_flow_into_a_glass_that_holds_it() {
    let form =
        ObstacleForm::Glass { floor_m: 0.01, floor_radius_m: 0.018, rim_m: 0.06, rim_radius_m: 0.022, drink_m: 0.01 };
    let glass = Obstacle { form, at_m: Vec3::ZERO, falls_m_s: 0.0, stands_s: 0.0 };
    let velocity_m_s = Vec3::NEG_Y;
    let jet = Jet { at_m: Vec3::new(0.002, 0.075, 0.0), radius_m: 0.005, velocity_m_s, until_s: 0.05 };
    let tank = Tank {
        cell_m: 0.004,
        ..tank([18, 20, 18], Fluid { jets: vec![jet], obstacles: vec![glass], ..Fluid::default() })
    };
    let start = at(&tank, 0.0).particles.len() as f32;
    let end = at(&tank, 0.2);
    let particle_m3 = tank.cell_m.powi(3) / Fluid::PARTICLES_PER_CELL as f32;
    let poured_m3 = (end.particles.len() as f32 - start) * particle_m3;
    // The disc of the jet is made of particles
    let expected_m3 = std::f32::consts::PI * 0.005_f32.powi(2) * 0.05;
    assert!((poured_m3 / expected_m3 - 1.0).abs() < 0.2, "{poured_m3} for {expected_m3}");
    for particle in &end.particles {
        let place = particle.at * tank.cell_m + tank.low_m();
        let radius = Vec3::new(place.x, 0.0, place.z).length();
        let inner = 0.018 + 0.08 * (place.y - 0.01);
        assert!(place.y > 0.0099 && (place.y > 0.06 || radius < inner + 1e-4), "{place}");
    }
}

#[test]
fn a_ball_that_falls_in_moves_the_water_away_and_stands_where_it_should() {
    let form = ObstacleForm::Ball { radius_m: 0.015 };
    let ball = Obstacle { form, at_m: Vec3::new(0.0, 0.005, 0.0), falls_m_s: 1.0, stands_s: 0.04 };
    let tank = Tank { water_m: 0.03, ..tank([16, 20, 16], Fluid { obstacles: vec![ball], ..Fluid::default() }) };
    let (start, end) = (at(&tank, 0.0), at(&tank, 0.06));
    assert_eq!(start.particles.len(), 16 * 16 * 6 * Fluid::PARTICLES_PER_CELL, "the ball is above the water");
    assert_eq!(start.particles.len(), end.particles.len());
    let middle = end.solids.cells_from_m(Vec3::new(0.0, 0.02, 0.0));
    let nearest = end.particles.iter().map(|p| p.at.distance(middle)).fold(f32::INFINITY, f32::min);
    assert!(nearest > 2.99, "{nearest} cells from the middle of a ball of 3");
    let highest = end.particles.iter().map(|p| p.at.y).fold(0.0, f32::max);
    assert!(highest > 6.5, "it splashes: {highest} cells");
}

#[test]
fn extremes_neither_fail_nor_lose_water() {
    assert_eq!(size_of::<Particle>(), 60, "the bound of memory is of this size");
    // Without air, without water, a single cell, all ground, more than there is room for
    let full = column([6, 6, 6], 6, 6);
    assert_eq!(at(&full, 0.05).particles.len(), 6 * 6 * 6 * 8);
    assert!(at(&tank([6, 6, 6], Fluid::default()), 0.05).particles.is_empty());
    assert_eq!(at(&column([1, 1, 1], 1, 1), 0.05).particles.len(), 8);
    let ground = Tank { terrain: Terrain::Flat { height_m: 1.0 }, water_m: 1.0, blocks: Vec::new(), ..full };
    assert!(at(&ground, 0.05).particles.is_empty());
    let jet = Jet { at_m: Vec3::Y * 0.01, radius_m: 1e5, velocity_m_s: Vec3::X * 100.0, until_s: 1e4 };
    let form = ObstacleForm::Box { size_m: Vec3::splat(1e5) };
    let obstacle = Obstacle { form, at_m: Vec3::Y * 0.02, falls_m_s: 100.0, stands_s: 1e4 };
    let fast = Drop { at_m: Vec3::ZERO, radius_m: 1e5, velocity_m_s: Vec3::splat(100.0) };
    let fluid = Fluid { jets: vec![jet], obstacles: vec![obstacle], drops: vec![fast], seed: 9 };
    let mad = at(&tank([4, 4, 4], fluid), 1.0 / 240.0);
    assert!(mad.particles.iter().all(|p| p.at.is_finite() && p.velocity.is_finite()));
}
