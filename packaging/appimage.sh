#!/usr/bin/env bash
# Builds the AppImage target/Catchlight-ARCH.AppImage, one file that runs on any Linux with the libraries that README
# names for the window. Needs mksquashfs (squashfs-tools), Python 3, and the AppImage runtime, the small program at the
# head of the file that mounts the rest: https://github.com/AppImage/type2-runtime, file runtime-ARCH.
#
#     packaging/appimage.sh RUNTIME
set -euo pipefail
cd "$(dirname "$0")/.."
if [ $# != 1 ] || [ ! -f "$1" ]; then
    echo "usage: $0 RUNTIME (runtime-$(uname -m) of github.com/AppImage/type2-runtime)" >&2
    exit 1
fi
runtime=$1 target=${CARGO_TARGET_DIR:-target}
folder="$target/package/AppDir" image="$target/Catchlight-$(uname -m).AppImage"

cargo build --release --locked
rm -rf "$folder"
mkdir -p "$folder/usr/bin" "$folder/usr/share/doc/catchlight" "$folder/usr/share/icons/hicolor/scalable/apps"
strip -o "$folder/usr/bin/catchlight" "$target/release/catchlight"
packaging/licences.py "$folder/usr/share/doc/catchlight/licences.txt"
cp README.md LICENSE-MIT LICENSE-APACHE "$folder/usr/share/doc/catchlight/"
# What the desktop reads: entry and icon lie at the top, too.
mkdir -p "$folder/usr/share/applications" "$folder/usr/share/mime/packages"
cp packaging/catchlight.desktop "$folder/usr/share/applications/"
cp packaging/catchlight.xml "$folder/usr/share/mime/packages/"
cp packaging/catchlight.svg "$folder/usr/share/icons/hicolor/scalable/apps/"
ln -s usr/share/applications/catchlight.desktop usr/share/icons/hicolor/scalable/apps/catchlight.svg "$folder/"
ln -s catchlight.svg "$folder/.DirIcon"
ln -s usr/bin/catchlight "$folder/AppRun"

# The same files give the same bytes.
rm -f "$folder.squashfs"
mksquashfs "$folder" "$folder.squashfs" -quiet -no-progress -root-owned -noappend -comp zstd -all-time 0 -mkfs-time 0
cat "$runtime" "$folder.squashfs" >"$image"
chmod +x "$image"
echo "$image"
