//! Lights with measured distributions: E = I cos / d2 with the intensity of the table.

use super::*;
use catchlight::raytrace::{LightMeter, MeterEffort, MeterPoint, RenderControl};
use catchlight::scene::IntensityTable;

/// Returns the assets of a table of revolution about no axis: a narrow beam with a wide foot, brighter to one side.
fn assets() -> Assets {
    let vertical: Vec<f32> = (0..=90).map(|row| row as f32).collect();
    let horizontal: Vec<f32> = (0..=24).map(|column| 15.0 * column as f32).collect();
    let intensity = |v: f32, h: f32| {
        let beam = 4000.0 * (-(v / 12.0).powi(2)).exp() + 500.0 * v.to_radians().cos().max(0.0);
        beam * (1.0 + 0.5 * h.to_radians().cos() * v.to_radians().sin())
    };
    let candela = horizontal.iter().flat_map(|&h| vertical.iter().map(move |&v| intensity(v, h))).collect();
    let mut assets = Assets::default();
    assets.insert_photometry("a.ies", Arc::new(IntensityTable::new(vertical, horizontal, candela).unwrap()));
    assets
}

#[test]
fn a_measured_light_has_the_intensity_of_its_table_in_every_emitter() {
    let Some(mut renderer) = shared_renderer() else { return };
    let assets = assets();
    let emitters = [
        Emitter::Point,
        Emitter::Spot { inner_deg: 10.0, outer_deg: 20.0 },
        Emitter::Sphere { radius_m: 0.05 },
        Emitter::RectPanel { width_m: 0.3, height_m: 0.6 },
        Emitter::RoundPanel { diameter_m: 0.5 },
    ];
    for emitter in emitters {
        let mut source = light(0, Vec3::new(0.5, 3.0, 0.0), Vec3::ZERO, emitter, Output::Candela(4500.0));
        source.photometric_file = Some("a.ies".to_owned());
        source.roll_deg = 40.0;
        let scene = floor_under(source);
        let mut input =
            PreviewInput { options: Options::direct_only(), ..PreviewInput::camera_view(&scene, &assets, (301, 201)) };
        input.options.shadows = false;
        let meter = LightMeter::new(&scene, &assets, Vec3::ZERO).unwrap();
        let effort = MeterEffort { paths: Some(4096), ..MeterEffort::default() };
        let points = [Vec3::ZERO, Vec3::X, Vec3::Z * -0.7, Vec3::new(-1.5, 0.0, 1.0), Vec3::new(2.5, 0.0, -2.0)];
        for point in points {
            let at =
                MeterPoint { position: point, facing: Vec3::Y, receptor: catchlight::photo::meter::Receptor::Flat };
            let expected = meter.read(&at, &effort, &RenderControl::new()).unwrap().reading.total_lux().0;
            // The texture has 129 x 256 texels; panels are averaged over 36 points.
            assert_close(lux_of(&mut renderer, &input, point), expected, 0.02, &format!("{emitter:?} {point}"));
        }
    }
}
