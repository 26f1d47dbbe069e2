"""Renders the studios with Mitsuba 3 (LLVM): its path tracer, 16 deep, with multi-jittered samples."""

import math
import time

import mitsuba
import numpy
import studios

mitsuba.set_variant("llvm_ad_rgb")
Transform = mitsuba.ScalarTransform4f


def rgb(values):
    return {"type": "rgb", "value": list(values)}


def bsdf(surface):
    if surface.kind == "matte":
        return {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": rgb(surface.color)}}
    if surface.kind == "plastic":
        return {
            "type": "roughplastic", "distribution": "ggx", "alpha": surface.roughness**2, "int_ior": 1.5,
            "diffuse_reflectance": rgb(surface.color), "nonlinear": False,
        }
    if surface.kind == "chrome":
        return {"type": "conductor", "material": "none", "specular_reflectance": rgb(surface.color)}
    return {"type": "dielectric", "int_ior": 1.5}


def shape(thing):
    if isinstance(thing, studios.Sphere):
        return {"type": "sphere", "radius": thing.radius, "center": thing.centre, "bsdf": bsdf(thing.surface)}
    if isinstance(thing, studios.Box):
        half = [size / 2 for size in thing.size]
        turned = Transform().translate(thing.centre) @ Transform().rotate([0, 1, 0], thing.turn_deg)
        return {"type": "cube", "to_world": turned @ Transform().scale(half), "bsdf": bsdf(thing.surface)}
    mesh = mitsuba.Mesh(
        thing.name, len(thing.positions), len(thing.triangles), has_vertex_normals=True,
        props=mesh_properties(thing.surface),
    )
    parameters = mitsuba.traverse(mesh)
    parameters["vertex_positions"] = numpy.array(thing.positions, numpy.float32).ravel()
    parameters["vertex_normals"] = numpy.array(thing.normals, numpy.float32).ravel()
    parameters["faces"] = numpy.array(thing.triangles, numpy.uint32).ravel()
    parameters.update()
    return mesh


def mesh_properties(surface):
    properties = mitsuba.Properties()
    properties["mesh_bsdf"] = mitsuba.load_dict(bsdf(surface))
    return properties


def emitter(panel):
    width, height = panel.size
    luminance = panel.lumens / (math.pi * width * height)
    # Straight down, Y cannot be up
    up = [0, 0, 1] if panel.position[0] == panel.aim[0] and panel.position[2] == panel.aim[2] else [0, 1, 0]
    placed = Transform().look_at(origin=panel.position, target=panel.aim, up=up)
    return {
        "type": "rectangle", "to_world": placed @ Transform().scale([width / 2, height / 2, 1]),
        "emitter": {"type": "area", "radiance": rgb([luminance / 1000] * 3)},
    }


class Mitsuba:
    name = f"Mitsuba {mitsuba.__version__}"

    def __init__(self, studio):
        half_angle = math.atan(studios.SENSOR_WIDTH_MM / 2 / studio.focal_length_mm)
        camera = {
            "type": "perspective", "fov": 2 * math.degrees(half_angle), "fov_axis": "x",
            "to_world": Transform().look_at(origin=studio.camera, target=studio.aim, up=[0, 1, 0]),
            "film": {
                "type": "hdrfilm", "width": studios.WIDTH, "height": studios.HEIGHT, "rfilter": {"type": "box"},
            },
            "sampler": {"type": "multijitter"},
        }
        scene = {"type": "scene", "integrator": {"type": "path", "max_depth": 16}, "camera": camera}
        scene |= {f"object{i}": shape(thing) for i, thing in enumerate(studio.objects)}
        scene |= {f"panel{i}": emitter(panel) for i, panel in enumerate(studio.panels)}
        self.scene = mitsuba.load_dict(scene)
        self.compiled = set()

    def render(self, samples, seed, reference=False):
        """Returns the picture, height x width x 3, and the seconds of tracing, without those to compile kernels."""
        if samples not in self.compiled:
            self.compiled.add(samples)
            self.trace(samples, seed + 1)
        return self.trace(samples, seed)

    def trace(self, samples, seed):
        began = time.monotonic()
        picture = numpy.array(mitsuba.render(self.scene, spp=samples, seed=seed))
        return picture[..., :3].astype(numpy.float64), time.monotonic() - began
