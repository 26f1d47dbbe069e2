#!/bin/bash
# A render on a Slurm cluster: an array of jobs, each of which renders a part of the samples of a picture, and a job that
# merges the parts when all of them are done.
#
#     farm/slurm.sh STUDIO PICTURE SPP PARTS [OPTIONS OF RENDER ...]
#     farm/slurm.sh studio.ron picture.exr 256 8 --size 1920x1280
#
# The folder must be one that all machines share. Parts stay in PICTURE.parts: run again, the script renders only those
# that are missing. CATCHLIGHT is the program (default: catchlight), CATCHLIGHT_SBATCH the command that submits a
# job, with options (default: sbatch). Without it the parts are rendered one after the other, here.
set -euo pipefail

catchlight=${CATCHLIGHT:-catchlight}
read -ra sbatch <<<"${CATCHLIGHT_SBATCH:-sbatch}"

# Renders part number $1, from 1 on.
render_part() {
    local part=$1 first end output working
    first=$(( (part - 1) * spp / parts ))
    end=$(( part * spp / parts ))
    output="$picture.parts/$first-$end.exr"
    if [ "$first" = "$end" ] || [ -e "$output" ]; then
        return
    fi
    # An interrupted part is a file of fewer samples: only a complete one gets its name.
    working="$picture.parts/working-$first-$end.exr"
    "$catchlight" render "$studio" --spp "$spp" --samples "$first..$end" "${options[@]}" --progress lines -o "$working"
    mv "$working" "$output"
}

merge_parts() {
    "$catchlight" merge "$picture".parts/[0-9]*.exr -o "$picture"
}

step=submit
case ${1:-} in
    --part | --merge) step=$1; shift ;;
esac
if [ $# -lt 4 ]; then
    echo "usage: $0 STUDIO PICTURE SPP PARTS [OPTIONS OF RENDER ...]" >&2
    exit 1
fi
studio=$1 picture=$2 spp=$3 parts=$4
options=("${@:5}")

case $step in
    --part) render_part "$SLURM_ARRAY_TASK_ID" ;;
    --merge) merge_parts ;;
    submit)
        mkdir -p "$picture.parts"
        if command -v "${sbatch[0]}" >/dev/null; then
            # A job that is preempted or whose machine fails is queued again.
            array=$("${sbatch[@]}" --parsable --requeue --array="1-$parts" --job-name=catchlight "$0" --part "$@")
            "${sbatch[@]}" --dependency="afterok:$array" --kill-on-invalid-dep=yes --job-name=catchlight-merge "$0" --merge "$@"
        else
            for (( part = 1; part <= parts; part++ )); do render_part "$part"; done
            merge_parts
        fi
        ;;
esac
