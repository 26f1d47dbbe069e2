#!/usr/bin/env python3
"""Compares Catchlight with other renderers on four studios and prints tables in Markdown.

    python3 -m venv peers-env
    peers-env/bin/pip install numpy OpenEXR flip-evaluator mitsuba bpy==5.0.1
    cargo build --release --no-default-features
    peers-env/bin/python peers/compare.py target/release/catchlight

Mitsuba needs LLVM, whose library DRJIT_LIBLLVM_PATH names if it does not find it (Debian: `apt-get install libllvm19`;
with LLVM 14 its rough plastic crashes). bpy wants the Python that its wheel names: 3.11.

`--studio NAME` takes only that one, `--budgets` compares denoised pictures after about 1 and 6 seconds with Cycles, in
place of the seconds that each renderer takes to a relative mean squared error of 1e-3 without a denoiser. Each renderer
is compared with its own reference, for materials differ in detail.
"""

import argparse
import math
import pathlib
import tempfile

import pictures
import studios
from with_catchlight import Catchlight

TARGET = 1e-3
BUDGETS_S = (1.0, 6.0)


def reference(renderer, seconds):
    """Renders two halves of a reference, which take about so many seconds together."""
    _, trial = renderer.render(16, seed=90, reference=True)
    samples = int(max(16, 16 * seconds / 2 / trial))
    # Multi-jittered samples want a square
    samples = math.isqrt(samples) ** 2
    return pictures.Reference(*(renderer.render(samples, seed, reference=True)[0] for seed in (100, 200)))


def seconds_to_target(renderer, true_picture):
    """Returns the seconds to the target, between two numbers of samples, and the milliseconds of a sample."""
    last = None
    for samples in (4**n for n in range(1, 9)):
        picture, seconds = renderer.render(samples, seed=1)
        error = true_picture.relative_mse(picture)
        print(f"    {renderer.name}: {samples} samples, {seconds:.2f} s, {error:.2e}", flush=True)
        if error <= TARGET:
            if last is None:
                return seconds, 1000 * seconds / samples
            part = math.log(last[1] / TARGET) / math.log(last[1] / error)
            return last[0] * (seconds / last[0]) ** part, 1000 * seconds / samples
        last = seconds, error
    return math.inf, 1000 * seconds / samples


def within_budget(renderer, true_picture, budget):
    """Returns seconds, relative MSE and FLIP of a denoised picture that takes about the budget."""
    samples, seconds = 1, 0.0
    for _ in range(5):
        picture, seconds = renderer.render(samples, seed=1, denoise=True)
        wanted = max(1, round(samples * (budget / seconds) ** 0.9))
        if 0.85 < seconds / budget < 1.15 or wanted == samples:
            break
        samples = wanted
    return seconds, true_picture.relative_mse(picture), true_picture.flip(picture)


def time_table(renderers, reference_s):
    """Prints a row for each renderer: seconds to the target and milliseconds a sample of every pixel."""
    for renderer in renderers:
        true_picture = reference(renderer, reference_s)
        print(f"    {renderer.name}: error of the reference {true_picture.own_error:.1e}", flush=True)
        seconds, sample_ms = seconds_to_target(renderer, true_picture)
        yield f"| {renderer.name} | {seconds:.2g} s | {sample_ms:.3g} ms |"


def budget_table(renderers, reference_s):
    """Prints a row for each renderer and budget: seconds, relative MSE and FLIP."""
    for renderer in renderers:
        true_picture = reference(renderer, reference_s)
        print(f"    {renderer.name}: error of the reference {true_picture.own_error:.1e}", flush=True)
        for budget in BUDGETS_S:
            seconds, error, flip = within_budget(renderer, true_picture, budget)
            yield f"| {renderer.name} | {seconds:.1f} s | {error:.1e} | {flip:.3f} |"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("catchlight", type=pathlib.Path, help="the program, built for release")
    parser.add_argument("--studio", action="append", help="name of a studio [default: all four]")
    parser.add_argument("--budgets", action="store_true", help="compare denoised pictures with Cycles")
    parser.add_argument("--reference-s", type=float, default=120.0, help="seconds for each reference [default: 120]")
    arguments = parser.parse_args()
    program = arguments.catchlight.resolve()
    rows = []
    for studio in studios.all_studios():
        if arguments.studio and studio.name not in arguments.studio:
            continue
        print(f"{studio.title}", flush=True)
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            ours = Catchlight(studio, folder, program)
            if arguments.budgets:
                from with_cycles import Cycles

                table = list(budget_table([ours, Cycles(studio, folder)], arguments.reference_s))
            else:
                from with_mitsuba import Mitsuba

                table = list(time_table([ours, Mitsuba(studio)], arguments.reference_s))
        rows += [f"\n{studio.title}:\n", *table]
    print("\n".join(rows))


if __name__ == "__main__":
    main()
