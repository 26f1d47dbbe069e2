//! The GPU that tests of preview and window need.

use catchlight::preview::Gpu;

/// Returns a GPU device without a window. Without an adapter the test is skipped with a message, or fails if
/// `CATCHLIGHT_REQUIRE_GPU` is set.
#[expect(clippy::print_stderr, reason = "a skipped test says so")]
pub fn headless_gpu() -> Option<Gpu> {
    match Gpu::headless() {
        Ok(gpu) => Some(gpu),
        Err(error) if std::env::var_os("CATCHLIGHT_REQUIRE_GPU").is_some() => {
            panic!("CATCHLIGHT_REQUIRE_GPU is set, but: {error}")
        }
        Err(error) => {
            eprintln!("\n!!! SKIPPED, no GPU adapter: {error}\n");
            None
        }
    }
}
