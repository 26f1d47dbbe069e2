//! `catchlight gear`, and the set-up sheet that compares a studio with it.

use super::catchlight;

#[test]
fn the_list_of_gear_names_its_sources_and_the_user_s_own_come_first() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("gear.ron");
    std::fs::write(
        &file,
        "(format: 1, heads: [(name: \"Mine\", output: FlashWs(energy_ws: 250.0), source: \"my meter\", owned: 1, \
         dial: (scale: Number(full: 6.0), lowest_stops: -5.0, steps_per_stop: 10))], \
         supports: [(name: \"Small stand\", kind: Stand, reach_m: 1.0, load_kg: 9.0, owned: 1)])",
    )
    .unwrap();
    let output = catchlight(folder.path(), &["gear", "--gear", "gear.ron"]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(0));
    let own = "  1 x Mine: Flash, 250 Ws, dial 1.0 to 6.0, 5500 K. Source: my meter";
    assert_eq!(text.lines().nth(1), Some(own), "{text}");
    assert!(text.lines().filter(|line| line.starts_with("  ")).all(|line| line.contains("Source: ")), "{text}");

    let arguments = ["sheet", "three_point", "--gear", "gear.ron", "-o", "plan.html", "--spp", "1"];
    let output = catchlight(folder.path(), &arguments);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let page = std::fs::read_to_string(folder.path().join("plan.html")).unwrap();
    assert!(page.contains("No stand of yours is left for") || page.contains("No boom of yours is left for"), "{page}");

    std::fs::write(&file, "(format: 1, heads: [(name: \"Mine\")])").unwrap();
    for arguments in [&["gear", "--gear", "gear.ron"][..], &["gear", "--gear", "none.ron"]] {
        let output = catchlight(folder.path(), arguments);
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{error}");
        assert!(error.contains("output") || error.contains("no list of gear"), "{error}");
    }
}
