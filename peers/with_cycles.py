"""Renders the studios with Cycles (Blender as a Python module) on the CPU."""

import math
import time

import bpy
import mathutils
import pictures
import studios


def material(surface):
    made = bpy.data.materials.new(surface.kind)
    made.use_nodes = True
    nodes, links = made.node_tree.nodes, made.node_tree.links
    nodes.clear()
    output = nodes.new("ShaderNodeOutputMaterial")
    if surface.kind == "matte":
        shader = nodes.new("ShaderNodeBsdfDiffuse")
        shader.inputs["Color"].default_value = (*surface.color, 1.0)
    elif surface.kind == "glass":
        shader = nodes.new("ShaderNodeBsdfGlass")
        shader.inputs["Roughness"].default_value = 0.0
        shader.inputs["IOR"].default_value = 1.5
    else:
        shader = nodes.new("ShaderNodeBsdfPrincipled")
        shader.inputs["Base Color"].default_value = (*surface.color, 1.0)
        shader.inputs["Roughness"].default_value = surface.roughness
        shader.inputs["IOR"].default_value = 1.5
        shader.inputs["Metallic"].default_value = float(surface.kind == "chrome")
    links.new(shader.outputs[0], output.inputs["Surface"])
    return made


def blender(v):
    """Returns a vector with Z up."""
    return mathutils.Vector((v[0], -v[2], v[1]))


def add(name, data, matrix=None):
    thing = bpy.data.objects.new(name, data)
    bpy.context.collection.objects.link(thing)
    if matrix is not None:
        thing.matrix_world = matrix
    return thing


def looking(position, aim):
    """Returns the placement of a camera or lamp, which look along -Z."""
    direction = blender(aim) - blender(position)
    return mathutils.Matrix.Translation(blender(position)) @ direction.to_track_quat("-Z", "Y").to_matrix().to_4x4()


def add_mesh(name, positions, triangles, surface, normals=None):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([blender(p) for p in positions], [], triangles)
    if normals is not None:
        mesh.normals_split_custom_set_from_vertices([blender(n) for n in normals])
    mesh.materials.append(material(surface))
    add(name, mesh)


def add_sphere(sphere, segments=128):
    ring = [(math.pi * i / segments, math.pi * j / segments) for i in range(segments + 1) for j in range(2 * segments)]
    normals = [(math.sin(t) * math.cos(p), math.cos(t), math.sin(t) * math.sin(p)) for t, p in ring]
    positions = [tuple(c + sphere.radius * n for c, n in zip(sphere.centre, normal)) for normal in normals]
    faces, width = [], 2 * segments
    for i in range(segments):
        for j in range(width):
            a, b, right = i * width, (i + 1) * width, (j + 1) % width
            faces.append((a + j, a + right, b + right, b + j))
    add_mesh(sphere.name, positions, faces, sphere.surface, normals)


def add_box(box):
    angle = math.radians(box.turn_deg)
    corners = []
    for i in range(8):
        x, y, z = ((1 if i >> axis & 1 else -1) * box.size[axis] / 2 for axis in range(3))
        turned = (x * math.cos(angle) + z * math.sin(angle), y, z * math.cos(angle) - x * math.sin(angle))
        corners.append(tuple(c + t for c, t in zip(box.centre, turned)))
    faces = [(0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6)]
    add_mesh(box.name, corners, faces, box.surface)


def add_panel(panel):
    lamp = bpy.data.lights.new(panel.name, "AREA")
    lamp.shape = "RECTANGLE"
    lamp.size, lamp.size_y = panel.size
    # Watts here are only a unit: a thousand lumens
    lamp.energy = panel.lumens / 1000
    add(panel.name, lamp, looking(panel.position, panel.aim))


class Cycles:
    """Cycles as it comes, on the CPU; a reference is without clamping and blurred gloss."""

    name = f"Cycles {bpy.app.version_string}"

    def __init__(self, studio, folder):
        self.output = folder / "cycles.exr"
        bpy.ops.wm.read_factory_settings(use_empty=True)
        for thing in studio.objects:
            if isinstance(thing, studios.Sphere):
                add_sphere(thing)
            elif isinstance(thing, studios.Box):
                add_box(thing)
            else:
                add_mesh(thing.name, thing.positions, thing.triangles, thing.surface, thing.normals)
        for panel in studio.panels:
            add_panel(panel)
        camera = bpy.data.cameras.new("Camera")
        camera.sensor_width, camera.sensor_fit = studios.SENSOR_WIDTH_MM, "HORIZONTAL"
        camera.lens = studio.focal_length_mm
        scene = bpy.context.scene
        scene.camera = add("Camera", camera, looking(studio.camera, studio.aim))
        scene.world = bpy.data.worlds.new("Black")
        scene.world.use_nodes = True
        scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.0
        scene.render.engine = "CYCLES"
        scene.render.resolution_x, scene.render.resolution_y = studios.WIDTH, studios.HEIGHT
        scene.render.filepath = str(self.output)
        scene.render.image_settings.file_format = "OPEN_EXR"
        scene.render.image_settings.color_depth = "32"
        scene.view_settings.view_transform = "Raw"
        scene.cycles.device = "CPU"
        scene.cycles.use_adaptive_sampling = False
        scene.cycles.pixel_filter_type = "BOX"
        self.scene, self.defaults = scene, (scene.cycles.sample_clamp_indirect, scene.cycles.blur_glossy)

    def render(self, samples, seed, reference=False, denoise=False):
        """Returns the picture, height x width x 3, and the seconds of the whole render."""
        cycles = self.scene.cycles
        cycles.samples, cycles.seed, cycles.use_denoising = samples, seed, denoise
        cycles.denoiser, cycles.denoising_input_passes = "OPENIMAGEDENOISE", "RGB_ALBEDO_NORMAL"
        cycles.sample_clamp_indirect, cycles.blur_glossy = (0.0, 0.0) if reference else self.defaults
        began = time.monotonic()
        bpy.ops.render.render(write_still=True)
        seconds = time.monotonic() - began
        return pictures.load(self.output), seconds
