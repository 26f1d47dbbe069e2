//! Checkpoints of a render that is killed.
#![cfg(unix)]

use super::running_render::{RunningRender, catchlight};
use super::{exr_channel, stderr};

#[test]
fn a_killed_render_goes_on_from_its_checkpoint_to_the_same_bits_as_one_run() {
    let folder = tempfile::tempdir().unwrap();
    let (picture, checkpoint) = (folder.path().join("x.exr"), folder.path().join("x.exr.checkpoint"));
    let options = ["--spp", "150", "--layers", "--aovs", "--noise", "0.03", "--checkpoint", "0.0001"];
    let arguments = |output| [&["render", "split", "-o", output, "--size", "64x96"], &options[..]].concat();
    let render = RunningRender::start(catchlight(), folder.path(), "x.exr", &options);
    while !checkpoint.exists() {
        std::thread::yield_now();
    }
    render.send("-KILL");
    assert_eq!(render.end().0, None);
    assert!(!picture.exists());
    // With another seed it is another picture.
    let resume = [&arguments("x.exr")[..], &["--resume"]].concat();
    let other = super::catchlight(folder.path(), &[&resume[..], &["--seed", "1"]].concat());
    assert_eq!(other.status.code(), Some(1), "{}", stderr(&other));
    assert!(stderr(&other).contains("of other settings") && checkpoint.exists(), "{}", stderr(&other));

    for arguments in [&resume, &arguments("whole.exr")] {
        let output = super::catchlight(folder.path(), arguments);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    }
    // The attributes in the file's head are in no particular order.
    let whole = folder.path().join("whole.exr");
    for channel in ["R", "G", "B", "albedo.G", "normal.X", "Z", "id"] {
        let values = |path| exr_channel(path, channel).unwrap();
        assert!(values(&picture) == values(&whole), "{channel}");
    }
    assert!(!checkpoint.exists(), "the picture is complete");
    // Without a checkpoint it begins anew.
    let again = super::catchlight(folder.path(), &resume);
    assert_eq!(again.status.code(), Some(0), "{}", stderr(&again));
    assert!(stderr(&again).contains("no checkpoint, it begins with the first sample: x.exr.checkpoint"));
}
