//! The drawing of a chart: error against seconds, both logarithmic, one line per method, and the front of the best.

use super::accuracy_row::{AccuracyRow, Study};
use super::front;
use anyhow::anyhow;
use plotters::prelude::*;
use std::path::Path;

/// Colours that colour-blind readers can distinguish (Okabe and Ito).
const COLORS: [RGBColor; 5] = [
    RGBColor(213, 94, 0),
    RGBColor(0, 114, 178),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
];

/// Draws the rows of the methods, without the studies of depth, threads and plan.
pub fn draw(path: &Path, title: &str, rows: &[AccuracyRow]) -> anyhow::Result<()> {
    draw_svg(path, title, rows).map_err(|error| anyhow!("can't draw {}: {error}", path.display()))
}

fn draw_svg(path: &Path, title: &str, rows: &[AccuracyRow]) -> Result<(), Box<dyn std::error::Error>> {
    let front = front::front(rows);
    let rows: Vec<&AccuracyRow> = rows.iter().filter(|row| row.study == Study::Method).collect();
    // An error of zero is clamped: the axes are logarithmic.
    let point = |row: &AccuracyRow| (row.trace_s.max(1e-5), row.error.rel_mse.max(1e-9));
    let range = |of: fn((f64, f64)) -> f64| {
        let values = rows.iter().map(|row| of(point(row)));
        let (low, high) = values.fold((f64::INFINITY, 0.0_f64), |(low, high), x| (low.min(x), high.max(x)));
        (low / 1.5)..(high * 1.5)
    };
    let area = SVGBackend::new(path, (800, 520)).into_drawing_area();
    area.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&area)
        .caption(format!("{title}: error against time"), ("sans-serif", 20))
        .margin(12)
        .x_label_area_size(44)
        .y_label_area_size(76)
        .build_cartesian_2d(range(|p| p.0).log_scale(), range(|p| p.1).log_scale())?;
    chart
        .configure_mesh()
        .max_light_lines(0)
        .bold_line_style(BLACK.mix(0.12))
        .x_labels(8)
        .y_labels(8)
        .x_desc("seconds of tracing, all cores")
        .y_desc("relative mean squared error")
        .x_label_formatter(&|x| format!("{x:.3}"))
        .y_label_formatter(&|y| format!("{y:.0e}"))
        .draw()?;
    // The front is drawn below the methods, broad and pale: each point is the best until the next one
    let steps = front.windows(2).flat_map(|pair| [point(pair[0]), (point(pair[1]).0, point(pair[0]).1)]);
    let steps: Vec<(f64, f64)> = steps.chain(front.last().map(|row| point(row))).collect();
    let broad = BLACK.mix(0.2).stroke_width(8);
    chart
        .draw_series(LineSeries::new(steps, broad))?
        .label("best in the time")
        .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], broad));
    let mut methods: Vec<&str> = rows.iter().map(|row| row.method.as_str()).collect();
    methods.dedup();
    for (method, color) in methods.into_iter().zip(COLORS.iter().cycle()) {
        let points: Vec<(f64, f64)> = rows.iter().filter(|row| row.method == method).map(|row| point(row)).collect();
        chart
            .draw_series(LineSeries::new(points.iter().copied(), color.stroke_width(2)).point_size(4))?
            .label(method)
            .legend(|(x, y)| PathElement::new([(x, y), (x + 18, y)], color.stroke_width(2)));
    }
    chart.configure_series_labels().background_style(WHITE.mix(0.85)).border_style(BLACK.mix(0.3)).draw()?;
    area.present()?;
    Ok(())
}
