#!/usr/bin/env bash
# Builds the Debian package: target/debian/catchlight_*.deb. Needs `cargo install cargo-deb` and Python 3.
set -euo pipefail
cd "$(dirname "$0")/.."
target=${CARGO_TARGET_DIR:-target}
cargo build --release --locked
"$target/release/catchlight" package-files target/package
packaging/licences.py target/package/licences.txt
cargo deb --no-build --locked --strip "$@"
