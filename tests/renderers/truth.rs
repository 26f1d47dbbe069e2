//! The README's table of closed forms: every row within its tolerance, and the README up to date.

use catchlight::truth;

#[test]
fn measurements_match_their_closed_forms_and_the_readme() {
    let rows = truth::rows();
    for row in &rows {
        let off = row.difference().abs();
        assert!(off <= row.tolerance, "{}: {} for {}, off by {off}", row.case, row.measured, row.closed_form);
    }
    // Cases and closed forms are equal; measured values may differ within the sampling error.
    let readme = include_str!("../../README.md");
    let mut table = truth::markdown(&rows);
    table.truncate(table.trim_end().len());
    let cells = |line: &str| -> Vec<String> { line.split('|').map(|cell| cell.trim().to_owned()).collect() };
    for line in table.lines().skip(2) {
        let [_, case, closed_form, ..] = &cells(line)[..] else { unreachable!("a row has four cells") };
        let found = readme.lines().map(cells).find(|row| row.get(1) == Some(case));
        let found = found.unwrap_or_else(|| vec![String::new(); 6]);
        let help = "paste the output of `cargo run --release -- truth` into the README";
        assert_eq!(found.get(2), Some(closed_form), "{case}: {help}");
        let row = rows.iter().find(|row| row.case == *case).unwrap();
        let stated: f64 = found[3].split_whitespace().next().unwrap().parse().unwrap();
        assert!((stated / row.closed_form - 1.0).abs() <= row.tolerance + 1e-4, "{case} is stated as {stated}: {help}");
    }
}
