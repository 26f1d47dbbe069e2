//! Random water tanks.

use super::any_scene::{number, vector};
use catchlight::scene::*;
use proptest::prelude::*;

pub(super) fn tank() -> impl Strategy<Value = Tank> {
    let height = || number(0.0, 1e5);
    let terrain = prop_oneof![
        height().prop_map(|height_m| Terrain::Flat { height_m }),
        (height(), height()).prop_map(|(floor_m, rim_m)| Terrain::Basin { floor_m, rim_m }),
        (any::<u32>(), height(), height(), number(1e-5, 1e5))
            .prop_map(|(seed, low_m, high_m, period_m)| Terrain::Hills { seed, low_m, high_m, period_m }),
        ("[a-z]{1,8}\\.png", height(), height()).prop_map(|(path, low_m, high_m)| Terrain::Picture {
            path,
            low_m,
            high_m
        }),
    ];
    let contents = [CellContent::Air, CellContent::Ground, CellContent::Metal, CellContent::Water];
    let cell = || [0..100_u16, 0..100, 0..100];
    let block = (cell(), cell(), 0..4_usize).prop_map(move |(a, b, content)| Block {
        from: [0, 1, 2].map(|axis| a[axis].min(b[axis])),
        to: [0, 1, 2].map(|axis| a[axis].max(b[axis])),
        content: contents[content],
    });
    let switches = proptest::collection::btree_set(0..1000_u16, 0..4);
    let spring = (vector(-0.1, 0.1), number(0.0, 1e6), switches).prop_map(|(at_m, litres_per_s, switches)| Spring {
        at_m,
        litres_per_s,
        switches_s: switches.into_iter().map(f32::from).collect(),
    });
    let stroke = (0..4_usize, 0.0..16.0_f32, proptest::collection::vec(vector(-0.1, 0.1), 0..4));
    let lists = (
        proptest::collection::vec(block, 0..3),
        proptest::collection::vec(spring, 0..3),
        proptest::collection::vec(stroke, 0..3),
    );
    (
        [1..=128_u16, 1..=128, 1..=128],
        number(1e-5, 1e5),
        terrain,
        lists,
        height(),
        number(0.0, 10.0),
        any::<bool>(),
        proptest::option::of(fluid()),
    )
        .prop_map(move |(cells, cell_m, terrain, (blocks, springs, strokes), water_m, time_s, is_smooth, fluid)| {
            let tank = Tank {
                cells,
                cell_m,
                terrain,
                blocks,
                strokes: strokes
                    .into_iter()
                    .map(|(content, cells, path_m)| BrushStroke {
                        content: contents[content],
                        radius_m: cells * cell_m,
                        path_m,
                    })
                    .collect(),
                water_m,
                springs,
                time_s,
                look: if is_smooth { TankLook::Smooth } else { TankLook::Cubes },
                fluid: None,
            };
            match fluid {
                // Fluids have fewer cells, less water and less time
                Some(fluid) => Tank {
                    cells: cells.map(|side| side % 40 + 1),
                    blocks: Vec::new(),
                    strokes: Vec::new(),
                    water_m: 0.0,
                    time_s: 0.05 * time_s,
                    fluid: Some(Box::new(fluid)),
                    ..tank
                },
                None => tank,
            }
        })
        .boxed()
}

fn fluid() -> impl Strategy<Value = Fluid> {
    let velocity = || vector(-100.0, 100.0);
    let drop =
        (vector(-0.1, 0.1), velocity()).prop_map(|(at_m, velocity_m_s)| Drop { at_m, radius_m: 1e-5, velocity_m_s });
    let jet = (vector(-0.1, 0.1), velocity(), number(0.0, 1e-6)).prop_map(|(at_m, velocity_m_s, until_s)| Jet {
        at_m,
        radius_m: 1e-5,
        velocity_m_s,
        until_s,
    });
    let size = || number(1e-5, 1e5);
    let form = prop_oneof![
        size().prop_map(|radius_m| ObstacleForm::Ball { radius_m }),
        vector(1e-5, 1e5).prop_map(|size_m| ObstacleForm::Box { size_m }),
        (size(), size()).prop_map(|(radius_m, height_m)| ObstacleForm::Cylinder { radius_m, height_m }),
        (number(1e-5, 0.1), number(0.2, 1e5), size(), size(), any::<bool>()).prop_map(
            |(floor_m, rim_m, floor_radius_m, rim_radius_m, is_full)| ObstacleForm::Glass {
                floor_m,
                floor_radius_m,
                rim_m,
                rim_radius_m,
                drink_m: if is_full { 1e-30 } else { 0.0 },
            }
        ),
    ];
    let obstacle = (form, vector(-1.0, 1.0), number(0.0, 100.0), number(0.0, 1e4))
        .prop_map(|(form, at_m, falls_m_s, stands_s)| Obstacle { form, at_m, falls_m_s, stands_s });
    let lists = (
        proptest::collection::vec(drop, 0..3),
        proptest::collection::vec(jet, 0..3),
        proptest::collection::vec(obstacle, 0..3),
    );
    (lists, any::<u32>()).prop_map(|((drops, jets, obstacles), seed)| Fluid { drops, jets, obstacles, seed }).boxed()
}
