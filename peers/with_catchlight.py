#!/usr/bin/env python3
"""Renders the studios with Catchlight. Alone, writes them as its studio files:

    peers/with_catchlight.py FOLDER [SEGMENTS]
"""

import json
import pathlib
import subprocess
import sys
import time

import studios


def material(surface):
    red, green, blue = surface.color
    color = f"base_color: ({red}, {green}, {blue})"
    if surface.kind == "matte":
        return f"Custom({color}, roughness: 1.0, ior: 1.0)"
    if surface.kind == "plastic":
        return f"Custom({color}, roughness: {surface.roughness})"
    if surface.kind == "chrome":
        return f"Custom({color}, roughness: {surface.roughness}, metallic: 1.0)"
    return f"Custom({color}, roughness: 0.0, transmission: 1.0)"


def vector(v):
    return "({}, {}, {})".format(*v)


def object_line(thing):
    rotation = ""
    if isinstance(thing, studios.Sphere):
        shape, position = f"Sphere(radius_m: {thing.radius})", thing.centre
    elif isinstance(thing, studios.Box):
        shape, position = f"Box(size_m: {vector(thing.size)})", thing.centre
        rotation = f"rotation_deg: (0.0, {thing.turn_deg}, 0.0), "
    else:
        shape, position = f'MeshFile(path: "{thing.name.lower()}.obj")', (0.0, 0.0, 0.0)
    surface = material(thing.surface)
    return f'(name: "{thing.name}", shape: {shape}, position: {vector(position)}, {rotation}material: {surface}),'


def light_line(panel):
    width, height = panel.size
    return (
        f'(name: "{panel.name}", role: Key, position: {vector(panel.position)}, aim: Point{vector(panel.aim)}, '
        f"emitter: RectPanel(width_m: {width}, height_m: {height}), "
        f"power: (output: Lumens({panel.lumens}), dial_stops: 0.0), color: Kelvin(5600.0)),"
    )


def write_obj(mesh, path):
    with open(path, "w") as out:
        out.writelines("v {:.6f} {:.6f} {:.6f}\n".format(*p) for p in mesh.positions)
        out.writelines("vn {:.5f} {:.5f} {:.5f}\n".format(*n) for n in mesh.normals)
        for triangle in mesh.triangles:
            out.write("f {0}//{0} {1}//{1} {2}//{2}\n".format(*(i + 1 for i in triangle)))


def write(studio, folder):
    """Writes a studio file, and its meshes beside it. Returns its path."""
    camera = (
        f"position: {vector(studio.camera)}, aim: Point{vector(studio.aim)}, sensor: FullFrame, "
        f"orientation: Landscape, focal_length_mm: {studio.focal_length_mm}, f_number: 4.0, shutter_s: 0.01, iso: 400.0, "
        "white_balance_k: 5600.0"
    )
    lines = [f'(format: 1, name: "{studio.title}", camera: ({camera}),', "objects: ["]
    lines += map(object_line, studio.objects)
    lines += ["],", "lights: [", *map(light_line, studio.panels), "],", ")"]
    for thing in studio.objects:
        if isinstance(thing, studios.Mesh):
            write_obj(thing, folder / f"{thing.name.lower()}.obj")
    path = folder / f"{studio.name}.ron"
    path.write_text("\n".join(lines) + "\n")
    return path


class Catchlight:
    """Catchlight's path tracer as it comes; a reference is without photons, cache and blurred gloss."""

    name = "Catchlight"

    def __init__(self, studio, folder, program):
        self.program, self.folder = program, folder
        self.path = write(studio, folder)

    def render(self, samples, seed, reference=False, denoise=False):
        """Returns the picture, height x width x 3, and the seconds of tracing (with `denoise`, of the whole process)."""
        options = ["--bounced-light", "paths"] if reference else []
        return self.run(["--spp", str(samples), *options], seed, denoise)

    def run(self, options, seed, denoise):
        size = f"{studios.WIDTH}x{studios.HEIGHT}"
        import pictures  # needs numpy, which writing the studios does not

        output = self.folder / "catchlight.exr"
        command = [self.program, "render", self.path, "--size", size, "--seed", str(seed), *options]
        command += ["--denoise", "on" if denoise else "off", "--json", "-o", output]
        began = time.monotonic()
        report = subprocess.run(command, check=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL).stdout
        seconds = time.monotonic() - began
        return pictures.load(output), seconds if denoise else json.loads(report)["trace_s"]


if __name__ == "__main__":
    folder = pathlib.Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for studio in studios.all_studios(*map(int, sys.argv[2:])):
        print(write(studio, folder))
