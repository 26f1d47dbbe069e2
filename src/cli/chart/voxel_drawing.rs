//! The drawing of the study of voxels: time of a frame against the view distance, both logarithmic.

use super::voxel_row::{VoxelRow, Way};
use anyhow::anyhow;
use plotters::prelude::*;
use std::path::Path;

/// Colours that colour-blind readers can distinguish (Okabe and Ito).
const COLORS: [RGBColor; 3] = [RGBColor(213, 94, 0), RGBColor(0, 114, 178), RGBColor(0, 158, 115)];

/// Draws one line for each way and number of bounces: thicker for more.
pub(super) fn draw(path: &Path, rows: &[VoxelRow]) -> anyhow::Result<()> {
    draw_svg(path, rows).map_err(|error| anyhow!("can't draw {}: {error}", path.display()))
}

fn draw_svg(path: &Path, rows: &[VoxelRow]) -> Result<(), Box<dyn std::error::Error>> {
    let point = |row: &VoxelRow| (f64::from(row.distance_cells), row.frame_ms.max(1e-3));
    let ends = rows.iter().map(|row| row.frame_ms.max(1e-3));
    let (low, high) = ends.fold((f64::INFINITY, 0.0_f64), |(low, high), y| (low.min(y), high.max(y)));
    let area = SVGBackend::new(path, (800, 520)).into_drawing_area();
    area.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&area)
        .caption("A frame of cells: time against view distance", ("sans-serif", 20))
        .margin(12)
        .x_label_area_size(44)
        .y_label_area_size(76)
        .build_cartesian_2d((0.8..180.0_f64).log_scale(), (low / 1.5..high * 1.5).log_scale())?;
    chart
        .configure_mesh()
        .max_light_lines(0)
        .bold_line_style(BLACK.mix(0.12))
        .x_desc("view distance, cells")
        .y_desc("milliseconds a frame, one thread")
        .draw()?;
    for (way, color) in Way::ALL.map(Way::label).into_iter().zip(COLORS) {
        for (bounces, width) in [(1, 1), (2, 2), (4, 3), (8, 4)] {
            let line = rows.iter().filter(|row| row.way == way && row.bounces == bounces).map(point);
            let series = chart.draw_series(LineSeries::new(line, color.stroke_width(width)).point_size(2))?;
            if bounces == 1 {
                series
                    .label(format!("{way}: 1, 2, 4, 8 bounces"))
                    .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], color.stroke_width(2)));
            }
        }
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperLeft)
        .background_style(WHITE.mix(0.85))
        .border_style(BLACK.mix(0.3))
        .draw()?;
    area.present()?;
    Ok(())
}
