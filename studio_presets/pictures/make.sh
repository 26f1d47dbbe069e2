#!/bin/bash
# Makes the pictures of the shipped studios that the list of studios shows. Needs ImageMagick, and a release build:
# studio_presets/pictures/make.sh [CATCHLIGHT] [STUDIO.ron ...]
set -euo pipefail
cd "$(dirname "$0")/.."
catchlight=${1:-../target/release/catchlight}
shift || true
[ $# -gt 0 ] || set -- *.ron
rendered=$(mktemp --suffix .png)
trap 'rm -f "$rendered"' EXIT
for studio in "$@"; do
    "$catchlight" render "$studio" --spp 16 --denoise on -o "$rendered"
    # Twice the size at which they are shown, for displays of high resolution
    convert "$rendered" -filter Lanczos -resize 224x224 -strip -quality 88 "pictures/${studio%.ron}.jpg"
done
