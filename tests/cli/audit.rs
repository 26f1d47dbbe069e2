//! `catchlight audit`: the light that comes by the room.

use super::{Value, catchlight, stderr, stdout};

#[test]
fn the_audit_lists_lights_surfaces_and_ceilings() {
    let folder = tempfile::tempdir().unwrap();
    let output = catchlight(folder.path(), &["audit", "three_point", "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let report: Value = serde_json::from_str(stdout(&output).trim()).unwrap();
    assert_eq!((report["lights"].as_array().unwrap().len(), report["ceilings"].as_array().unwrap().len()), (4, 2));
    let total = &report["total"]["added_stops"];
    assert!(total["Walls"].as_f64().unwrap() < 0.2, "a dark room: {report}");
    // The background light reaches the subject by way of the paper
    let background = &report["lights"][3]["added_stops"]["Backdrops, panels"];
    assert!(report["lights"][3]["added_stops"].get("Backdrops, panels").is_some());
    assert!(background.is_null() || background.as_f64().unwrap() > 3.0, "{report}");
    assert_eq!(report["flaring"][0], "Hair strip");
    let output = catchlight(folder.path(), &["audit", "no such studio"]);
    assert_eq!(output.status.code(), Some(1));
}
