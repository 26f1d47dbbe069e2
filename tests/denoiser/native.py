#!/usr/bin/env python3
"""Writes the pictures with which a test of src/denoise/ compares: those of Intel Open Image Denoise itself.

    pip install numpy pyoidn==2.5.1.0
    tests/denoiser/native.py tests/denoiser

The input is made of integers, so that the test makes the same bits.
"""

import sys

import numpy
import pyoidn

WIDTH, HEIGHT = 61, 45


def hashed(count):
    """Returns pseudo-random integers from 0 to 255: the upper byte of a linear congruential generator."""
    values, state = [], 1
    for _ in range(count):
        state = (state * 1664525 + 1013904223) % 2**32
        values.append(state >> 24)
    return numpy.array(values, numpy.float32)


def scene():
    """Returns noisy colour, albedo and normals of a bright disc in front of two grounds."""
    y, x = numpy.mgrid[0:HEIGHT, 0:WIDTH].astype(numpy.float32)
    disc = (x - 30) ** 2 + (y - 20) ** 2 < 200
    left = x < 40
    albedo = numpy.where(disc, 0.75, numpy.where(left, 0.5, 0.125)).astype(numpy.float32)
    albedo = albedo[..., None] * numpy.array([1, 0.5, 0.25], numpy.float32)
    normal = numpy.stack([(x - 30) / 32, (20 - y) / 32, numpy.where(disc, 0.5, 1.0)], -1).astype(numpy.float32)
    noise = hashed(WIDTH * HEIGHT * 3).reshape(HEIGHT, WIDTH, 3) / numpy.float32(64)
    light = numpy.where(disc, 4.0, 0.25).astype(numpy.float32)
    return albedo * light[..., None] * noise, albedo, normal


def main():
    color, albedo, normal = scene()
    for name, quality in (("best", "high"), ("fast", "fast")):
        denoised = pyoidn.denoise(color, albedo, normal, hdr=True, quality=quality)
        denoised.astype("<f4").tofile(f"{sys.argv[1]}/native_{name}.f32")


if __name__ == "__main__":
    main()
