//! Tests of the readers, with small files of their own.

use super::{Format, PhotometricFile, encode, read_photometric_file};
use crate::scene::{Emitter, IntensityTable};
use glam::Vec3;
use std::f32::consts::PI;

fn lm63(text: &str) -> Result<PhotometricFile, String> {
    Format::Lm63.parse(text.as_bytes())
}

fn table(text: &str) -> IntensityTable {
    lm63(text).unwrap().table
}

fn ldt(text: &str) -> Result<PhotometricFile, String> {
    Format::Eulumdat.parse(text.as_bytes())
}

/// Returns an IES file with these angles, type and intensities.
fn ies(kind: u32, vertical: &[f32], horizontal: &[f32], candela: impl Fn(f32, f32) -> f32) -> String {
    let join = |numbers: Vec<f32>| numbers.iter().map(f32::to_string).collect::<Vec<_>>().join(" ");
    let planes = horizontal.iter().map(|&h| join(vertical.iter().map(|&v| candela(v, h)).collect()));
    let (rows, columns) = (vertical.len(), horizontal.len());
    let planes = planes.collect::<Vec<_>>().join("\n");
    format!(
        "IESNA:LM-63-2002\n[TEST] 1\n[MANUFAC] Own\n[LUMINAIRE] Test lamp\nTILT=NONE\n1 1000 1 {rows} {columns} {kind} 2 0.3 \
         0.6 0\n1 1 100\n{}\n{}\n{planes}\n",
        join(vertical.to_vec()),
        join(horizontal.to_vec())
    )
}

/// Returns the angles from `first` to `last`.
fn steps(first: f32, last: f32, step: f32) -> Vec<f32> {
    (0..).map(|i| first + step * i as f32).take_while(|angle| *angle <= last + 1e-3).collect()
}

/// An intensity that is symmetric about both planes.
fn quadrants(vertical: f32, horizontal: f32) -> f32 {
    let (v, h) = (vertical.to_radians(), horizontal.to_radians());
    1000.0 * (v * 0.5).cos() * (1.0 + 0.5 * (2.0 * h).cos() * v.sin())
}

const EULUMDAT_HEAD: [&str; 3] = ["Own works", "1", "0"];

/// Returns a EULUMDAT file of 24 C-planes and 19 angles, with this symmetry, of lamps of 2000 lm.
fn eulumdat(symmetry: usize, candela: impl Fn(f32, f32) -> f32) -> String {
    let (c_deg, gamma_deg) = (steps(0.0, 345.0, 15.0), steps(0.0, 180.0, 10.0));
    let mut lines: Vec<String> = EULUMDAT_HEAD[..2].iter().map(|line| (*line).to_owned()).collect();
    lines.push(symmetry.to_string());
    for line in ["24", "15", "19", "10", "report", "Downlight", "42", "own.ldt", "today", "600", "300", "80"] {
        lines.push(line.to_owned());
    }
    for line in
        ["600", "300", "0", "0", "0", "0", "100", "100,0", "1.0", "0", "1", "2", "LED", "2000", "3000", "80", "20"]
    {
        lines.push(line.to_owned());
    }
    lines.extend((0..10).map(|_| "0.5".to_owned()));
    lines.extend(c_deg.iter().chain(&gamma_deg).map(f32::to_string));
    let (first, planes) = [(0, 24), (0, 1), (0, 13), (18, 13), (0, 7)][symmetry];
    for plane in first..first + planes {
        lines.extend(gamma_deg.iter().map(|&gamma| (candela(gamma, c_deg[plane % 24]) / 2.0).to_string()));
    }
    lines.join("\r\n")
}

/// Returns directions that cover the sphere.
fn directions() -> impl Iterator<Item = Vec3> {
    let golden = PI * (3.0 - 5.0_f32.sqrt());
    (0..500).map(move |i| {
        let z = 1.0 - (i as f32 + 0.5) / 250.0;
        let (sin, cos) = (golden * i as f32).sin_cos();
        let across = (1.0 - z * z).sqrt();
        Vec3::new(across * cos, across * sin, z)
    })
}

fn assert_same(one: &IntensityTable, other: &IntensityTable, what: &str) {
    for direction in directions() {
        let (a, b) = (one.candela_towards(direction), other.candela_towards(direction));
        assert!((a - b).abs() < 0.1, "{what} {direction}: {a} and {b}");
    }
    assert!((one.flux_lm() / other.flux_lm() - 1.0).abs() < 1e-4, "{what}");
}

#[test]
fn all_symmetries_of_one_distribution_give_the_same_intensities() {
    let vertical = steps(0.0, 180.0, 10.0);
    let of = |first: f32, last: f32| table(&ies(1, &vertical, &steps(first, last, 15.0), quadrants));
    let whole = of(0.0, 360.0);
    assert!((whole.candela_towards(Vec3::X) - 1000.0 * 0.5_f32.sqrt() * 1.5).abs() < 0.1);
    assert!((whole.candela_towards(Vec3::Y) - 1000.0 * 0.5_f32.sqrt() * 0.5).abs() < 0.1);
    for (first, last) in [(0.0, 90.0), (0.0, 180.0), (90.0, 270.0), (0.0, 345.0)] {
        assert_same(&of(first, last), &whole, &format!("IES {first} to {last}"));
    }
    for symmetry in [0, 2, 3, 4] {
        let file = ldt(&eulumdat(symmetry, quadrants)).unwrap();
        assert_same(&file.table, &whole, &format!("EULUMDAT {symmetry}"));
    }
    // About its axis
    let round = |v: f32, _: f32| quadrants(v, 45.0);
    let whole = table(&ies(1, &vertical, &steps(0.0, 360.0, 30.0), round));
    assert_same(&table(&ies(1, &vertical, &[0.0], round)), &whole, "IES round");
    assert_same(&ldt(&eulumdat(1, round)).unwrap().table, &whole, "EULUMDAT round");
}

#[test]
fn planes_that_are_symmetric_about_one_plane_only_keep_their_sides() {
    // More to the right (C0) than to the left; alike above and below
    let lopsided = |v: f32, h: f32| 500.0 + 400.0 * v.to_radians().sin() * h.to_radians().cos();
    let vertical = steps(0.0, 90.0, 10.0);
    let about_0 = table(&ies(1, &vertical, &steps(0.0, 180.0, 15.0), lopsided));
    let sides = [Vec3::X, Vec3::Y, Vec3::NEG_X, Vec3::NEG_Y].map(|side| about_0.candela_towards(side));
    for (ours, expected) in sides.into_iter().zip([900.0, 500.0, 100.0, 500.0]) {
        assert!((ours - expected).abs() < 0.1, "{sides:?}");
    }
    assert_same(&ldt(&eulumdat(2, lopsided)).unwrap().table, &ldt(&eulumdat(0, lopsided)).unwrap().table, "C0");
    // Alike to both sides, more upwards (C90)
    let upwards = |v: f32, h: f32| 500.0 + 400.0 * v.to_radians().sin() * h.to_radians().sin();
    let about_90 = table(&ies(1, &vertical, &steps(90.0, 270.0, 15.0), upwards));
    let sides = [Vec3::X, Vec3::Y, Vec3::NEG_X, Vec3::NEG_Y].map(|side| about_90.candela_towards(side));
    for (ours, expected) in sides.into_iter().zip([500.0, 900.0, 500.0, 100.0]) {
        assert!((ours - expected).abs() < 0.1, "{sides:?}");
    }
    assert_same(&ldt(&eulumdat(3, upwards)).unwrap().table, &ldt(&eulumdat(0, upwards)).unwrap().table, "C90");
}

#[test]
fn a_thousand_candela_everywhere_are_4000_pi_lumens_in_every_format() {
    let vertical = steps(0.0, 180.0, 5.0);
    let ies = table(&ies(1, &vertical, &[0.0], |_, _| 1000.0));
    let eulumdat = ldt(&eulumdat(4, |_, _| 1000.0)).unwrap();
    for flux in [ies.flux_lm(), eulumdat.table.flux_lm()] {
        assert!((flux / (4000.0 * PI) - 1.0).abs() < 1e-4, "{flux} lm");
    }
    let warning = "its intensities give 12566 lm, but its lamps and light output ratio 2000 lm";
    assert_eq!(eulumdat.warnings, [warning]);
    assert_eq!((ies.luminaire.as_str(), eulumdat.table.luminaire.as_str()), ("Own Test lamp", "Own works Downlight"));
    assert_eq!(ies.opening, Emitter::RectPanel { width_m: 0.3, height_m: 0.6 });
    assert_eq!(eulumdat.table.opening, ies.opening);
}

#[test]
fn type_a_and_b_have_the_directions_of_their_goniometers() {
    // The intensity is the vertical angle plus a thousandth of the horizontal one, so that it tells both
    let tells = |v: f32, h: f32| 1000.0 + v + 1e-3 * (h + 90.0);
    let (vertical, horizontal) = (steps(-90.0, 90.0, 2.5), steps(-90.0, 90.0, 2.5));
    let a = table(&ies(3, &vertical, &horizontal, tells));
    let b = table(&ies(2, &vertical, &horizontal, tells));
    // 30 degrees up and 40 degrees to the right, by hand: A (cos v sin h, sin v, cos v cos h), B (sin h, cos h sin v,
    // cos h cos v), with the beam along -Z
    let (v, h) = (30_f32.to_radians(), 40_f32.to_radians());
    let direction_a = Vec3::new(v.cos() * h.sin(), v.sin(), -v.cos() * h.cos());
    let direction_b = Vec3::new(h.sin(), h.cos() * v.sin(), -h.cos() * v.cos());
    for (table, direction, other) in [(&a, direction_a, direction_b), (&b, direction_b, direction_a)] {
        assert!((table.candela_towards(direction) - tells(30.0, 40.0)).abs() < 0.02);
        assert!((table.candela_towards(other) - tells(30.0, 40.0)).abs() > 1.0);
        assert!((table.candela_towards(Vec3::NEG_Z) - tells(0.0, 0.0)).abs() < 1e-2);
        assert_eq!(table.candela_towards(Vec3::Z), 0.0);
    }
    // Only B has a hemisphere of light for equal intensities from -90 to 90: both cover it
    for kind in [2, 3] {
        let flux = table(&ies(kind, &vertical, &horizontal, |_, _| 1000.0)).flux_lm();
        assert!((flux / (2000.0 * PI) - 1.0).abs() < 1e-4, "type {kind}: {flux} lm");
        // Horizontal angles from 0 are mirrored
        let half = table(&ies(kind, &vertical, &steps(0.0, 90.0, 2.5), |v, h| 2000.0 - 3.0 * h + v));
        let whole = table(&ies(kind, &vertical, &horizontal, |v, h| 2000.0 - 3.0 * h.abs() + v));
        assert_same(&half, &whole, "mirrored");
    }
}

#[test]
fn factors_multiply_and_tilt_is_kept() {
    let plain = table(&ies(1, &[0.0, 90.0], &[0.0], |_, _| 100.0));
    let text = |head: &str, tilt: &str, factors: &str, rest: &str| {
        table(&format!("{head}\nTILT={tilt}\n1 -1 2 2 1 1 1 0 0 0\n{factors} 30\n0 90 0 {rest}\n"))
    };
    let scaled = text("IESNA:LM-63-1995", "NONE", "0.9 1", "100 100");
    assert!((scaled.flux_lm() / plain.flux_lm() - 1.8).abs() < 1e-5);
    assert_eq!(scaled.opening, Emitter::Point);
    // The ballast-lamp factor of 1986, whose files begin with any text; the type of the file in 2019
    let older = text("some lamp, 1987", "NONE", "0.9,0.5", "100, 100");
    assert!((older.flux_lm() / plain.flux_lm() - 0.9).abs() < 1e-5);
    let newer = text("IES:LM-63-2019", "NONE", "1.0 1.10001", "100 100");
    assert!((newer.flux_lm() / plain.flux_lm() - 2.0).abs() < 1e-5);
    let tilted = text("IESNA91", "INCLUDE\r1\r3\r0 45 90\r1 .8 .6", "1 1", "100 100");
    assert_eq!(tilted.tilt, [[0.0, 1.0], [45.0, 0.8], [90.0, 0.6]]);
    // Lines may break anywhere
    let broken = ies(1, &[0.0, 45.0, 90.0], &[0.0, 90.0], quadrants);
    let (head, numbers) = broken.split_once("TILT=NONE\n").unwrap();
    let broken = format!("{head}TILT=NONE\n{}", numbers.replace(' ', "\r\n").replace('\n', "\n\n"));
    assert_same(&table(&broken), &table(&ies(1, &[0.0, 45.0, 90.0], &[0.0, 90.0], quadrants)), "broken lines");
}

#[test]
fn mistakes_are_named_with_their_line() {
    let good = ies(1, &[0.0, 90.0], &[0.0, 90.0], |_, _| 10.0);
    let bad = |from: &str, to: &str| lm63(&good.replace(from, to)).unwrap_err();
    assert_eq!(bad("TILT=NONE", ""), "there is no line TILT=, which every IES file has");
    assert!(bad("TILT=NONE", "TILT=lamp.tlt").starts_with("line 5: TILT=lamp.tlt: the tilt data lie in another file"));
    assert_eq!(bad("1 1000 1", "1 thousand 1"), "line 6: the lumens per lamp is \"thousand\", not a number");
    assert_eq!(
        bad("1 1000 1 2 2", "1 1000 1 1e9 2"),
        "line 6: the number of vertical angles is \"1e9\"; it must be from 2 to 10000"
    );
    assert!(bad("2 2 1 2", "2 2 7 2").contains("photometric type (1 C, 2 B, 3 A) is \"7\""));
    assert!(bad("\n0 90\n0 90\n", "\n90 0\n0 90\n").contains("the vertical angles must ascend, but 0 follows 90"));
    assert!(bad("\n0 90\n0 90\n", "\n0 90\n0 75\n").contains("the horizontal angles go from 0 to 75"));
    assert!(bad("10 10\n10 10", "10 10\n10 -3").contains("-3 cd is no intensity"));
    assert!(bad("10 10\n10 10", "10 10\n10").contains("the file ends before the intensities"));
    assert!(bad("10 10\n10 10", "0 0\n0 0").contains("it gives no light"));
    let good = eulumdat(4, |_, _| 10.0);
    let bad = |from: &str, to: &str| ldt(&good.replacen(from, to, 1)).unwrap_err();
    assert_eq!(
        bad("\r\n24\r\n", "\r\nmany\r\n"),
        "line 4: the number of C-planes (line 4) is \"many\"; it must be from 1 to 3600"
    );
    assert!(bad("2000", "0").contains("the lamps' 0 lm give no factor"));
    for name in ["lamp.txt", "lamp"] {
        let error = read_photometric_file(std::path::Path::new(name)).unwrap_err().to_string();
        assert!(error.contains(".ies (IES LM-63) and .ldt (EULUMDAT)"), "{error}");
    }
}

#[test]
fn files_that_are_cut_or_changed_at_any_byte_do_not_panic() {
    let tilted = ies(1, &[0.0, 45.0, 90.0], &[0.0, 90.0, 180.0], quadrants)
        .replace("TILT=NONE", "TILT=INCLUDE\n1\n2\n0 90\n1 0.5");
    let across = ies(2, &[-30.0, 0.0, 30.0], &[0.0, 20.0], |v, _| 100.0 + v);
    let files = [(Format::Lm63, tilted), (Format::Lm63, across), (Format::Eulumdat, eulumdat(3, quadrants))];
    for (format, text) in files {
        let bytes = text.as_bytes();
        assert!(format.parse(bytes).is_ok());
        let mut refused = 0;
        for cut in 0..bytes.len() {
            refused += usize::from(format.parse(&bytes[..cut]).is_err());
            let mut changed = bytes.to_vec();
            for byte in *b"9-.e \n\xff" {
                changed[cut] = byte;
                if let Ok(file) = format.parse(&changed) {
                    let flux = file.table.flux_lm();
                    assert!(flux.is_finite() && flux > 0.0 && file.table.candela_towards(Vec3::X).is_finite());
                }
            }
        }
        assert!(refused > bytes.len() * 9 / 10, "{format:?}: {refused} of {}", bytes.len());
    }
}

#[test]
fn a_table_is_written_as_a_file_that_reads_alike() {
    let mut whole = table(&ies(1, &steps(0.0, 180.0, 7.5), &steps(0.0, 360.0, 22.5), quadrants));
    whole.tilt = vec![[0.0, 1.0], [90.0, 0.75]];
    whole.luminaire = "Test lamp".to_owned();
    assert_eq!(table(&encode(&whole)), whole);
}
