"""The studios of the comparison as plain data, which each renderer's module translates.

Y is up; metres, lumens, degrees; colours are scene-linear RGB with Rec.709 primaries.
"""

import math
from dataclasses import dataclass, field

WIDTH, HEIGHT = 320, 240
# The part of a full-frame sensor, 24 mm high, that a picture of 4:3 takes
SENSOR_WIDTH_MM = 32.0


@dataclass
class Surface:
    """A surface: `matte`, `plastic` (a coat of index 1.5 over a matte base), `chrome` or `glass` (index 1.5)."""

    kind: str
    color: tuple = (1.0, 1.0, 1.0)
    roughness: float = 0.0


@dataclass
class Sphere:
    name: str
    centre: tuple
    radius: float
    surface: Surface


@dataclass
class Box:
    name: str
    centre: tuple
    size: tuple
    surface: Surface
    turn_deg: float = 0.0


@dataclass
class Mesh:
    """Triangles with a normal at each vertex: lists of (x, y, z), (x, y, z) and (a, b, c)."""

    name: str
    positions: list
    normals: list
    triangles: list
    surface: Surface


@dataclass
class Panel:
    """A rectangle that emits evenly to its front: Lambert's law."""

    name: str
    position: tuple
    aim: tuple
    size: tuple
    lumens: float


@dataclass
class Studio:
    """A studio, with the focal length for a full-frame camera."""

    name: str
    title: str
    camera: tuple
    aim: tuple
    focal_length_mm: float
    objects: list = field(default_factory=list)
    panels: list = field(default_factory=list)


CHROME = Surface("chrome", (0.55, 0.556, 0.554))
GLASS = Surface("glass")


def matte(*color):
    """Returns a surface that scatters evenly."""
    return Surface("matte", color)


def plastic(roughness, *color):
    """Returns a coat of a roughness, whose square is the alpha of GGX, over a matte base."""
    return Surface("plastic", color, roughness)


def diffuse_room():
    """A closed room of matte walls, lit by one panel under its ceiling: nearly all light has bounced."""
    walls = matte(0.7, 0.7, 0.7)
    return Studio(
        "diffuse_room", "closed diffuse room, one panel under its ceiling", (0.0, 1.5, 2.3), (0.0, 1.2, -1.0), 24.0,
        [
            Box("Floor", (0.0, -0.05, 0.0), (4.2, 0.1, 5.2), walls),
            Box("Ceiling", (0.0, 3.05, 0.0), (4.2, 0.1, 5.2), walls),
            Box("Left wall", (-2.05, 1.5, 0.0), (0.1, 3.0, 5.2), matte(0.7, 0.4, 0.4)),
            Box("Right wall", (2.05, 1.5, 0.0), (0.1, 3.0, 5.2), matte(0.4, 0.7, 0.4)),
            Box("Back wall", (0.0, 1.5, -2.55), (4.0, 3.0, 0.1), walls),
            Box("Front wall", (0.0, 1.5, 2.55), (4.0, 3.0, 0.1), walls),
            Sphere("Ball", (-0.5, 0.5, -0.8), 0.5, matte(0.7, 0.3, 0.2)),
            Box("Block", (0.7, 0.6, -1.2), (0.6, 1.2, 0.6), matte(0.3, 0.5, 0.6), 30.0),
        ],
        [Panel("Key", (0.0, 2.9, -0.5), (0.0, 0.0, -0.5), (0.9, 0.9), 12000.0)],
    )


def plastic_things():
    """Things of plastic before a wall, lit by three panels."""
    aim = (0.0, 0.5, 0.0)
    return Studio(
        "plastic", "plastic, three panels", (0.0, 1.3, 3.2), (0.0, 0.55, 0.0), 50.0,
        [
            Box("Floor", (0.0, -0.05, 0.0), (8.0, 0.1, 8.0), plastic(0.5, 0.6, 0.6, 0.6)),
            Box("Wall", (0.0, 2.0, -1.5), (8.0, 4.0, 0.1), plastic(0.6, 0.5, 0.55, 0.6)),
            Sphere("Red ball", (0.0, 0.5, 0.0), 0.5, plastic(0.25, 0.7, 0.15, 0.1)),
            Sphere("Blue ball", (-0.8, 0.3, 0.3), 0.3, plastic(0.15, 0.1, 0.3, 0.7)),
            Box("Green block", (0.85, 0.35, 0.1), (0.5, 0.7, 0.5), plastic(0.3, 0.2, 0.6, 0.25), 30.0),
        ],
        [
            Panel("Key", (-1.8, 2.4, 1.6), aim, (0.9, 0.9), 12000.0),
            Panel("Fill", (2.2, 1.6, 1.8), aim, (1.2, 0.8), 4000.0),
            Panel("Top", (0.3, 2.8, -0.8), aim, (0.4, 1.2), 6000.0),
        ],
    )


def chrome_and_glass():
    """Mirrors and glass on a matte table, lit by two panels: caustics, seen directly and in mirrors."""
    aim = (0.0, 0.15, 0.0)
    return Studio(
        "chrome_glass", "chrome and glass, two panels", (0.0, 0.75, 1.9), (0.0, 0.18, 0.0), 60.0,
        [
            Box("Table", (0.0, -0.05, 0.0), (4.0, 0.1, 3.0), matte(0.5, 0.48, 0.45)),
            Box("Backdrop", (0.0, 1.0, -1.05), (4.0, 2.2, 0.1), matte(0.55, 0.55, 0.6)),
            Sphere("Chrome ball", (-0.32, 0.2, -0.05), 0.2, CHROME),
            Sphere("Glass ball", (0.12, 0.15, 0.25), 0.15, GLASS),
            Box("Glass block", (0.42, 0.2, -0.15), (0.16, 0.4, 0.16), GLASS, 25.0),
            Box("Red block", (0.02, 0.12, -0.4), (0.3, 0.24, 0.2), matte(0.6, 0.15, 0.12), -15.0),
        ],
        [
            Panel("Key", (-1.2, 1.5, 0.9), aim, (0.6, 0.6), 8000.0),
            Panel("Fill", (1.5, 1.1, 0.8), aim, (0.4, 0.8), 3000.0),
        ],
    )


def pebbles(columns, rows, segments):
    """Returns a mesh of lumpy balls on a grid, 4 `segments` squared triangles each, of radius about 0.2 m."""
    positions, normals, triangles = [], [], []
    for ball in range(columns * rows):
        x0, z0 = (ball % columns - (columns - 1) / 2) * 0.5, (ball // columns - (rows - 1) / 2) * 0.5
        first, phase = len(positions), 0.7 * ball

        def point(theta, phi):
            lumps = math.sin(9.0 * theta + phase) * math.sin(8.0 * phi + 2.0 * phase)
            radius = 0.2 * (1.0 + 0.06 * lumps * math.sin(theta))
            sin_theta = math.sin(theta)
            return (
                x0 + radius * sin_theta * math.cos(phi),
                0.22 + radius * math.cos(theta),
                z0 + radius * sin_theta * math.sin(phi),
            )

        for i in range(segments + 1):
            for j in range(2 * segments):
                theta, phi, step = math.pi * i / segments, math.pi * j / segments, 1e-3
                theta = min(max(theta, 1e-3), math.pi - 1e-3)
                along_theta = [a - b for a, b in zip(point(theta + step, phi), point(theta - step, phi))]
                along_phi = [a - b for a, b in zip(point(theta, phi + step), point(theta, phi - step))]
                positions.append(point(theta, phi))
                normals.append(normalized(cross(along_phi, along_theta)))
        for i in range(segments):
            for j in range(2 * segments):
                a, b = (first + (i + k) * 2 * segments for k in (0, 1))
                right = (j + 1) % (2 * segments)
                triangles += [(a + j, a + right, b + right), (a + j, b + right, b + j)]
    return positions, normals, triangles


def many_lights(segments):
    """A field of lumpy balls of plastic under 60 panels; a million triangles with 100 segments."""
    panels = []
    for i in range(60):
        ring, place = divmod(i, 20)
        angle, distance = 2.0 * math.pi * (place + 0.3 * ring) / 20, (3.2, 2.4, 1.4)[ring]
        position = (distance * math.cos(angle), (1.4, 2.3, 2.9)[ring], distance * math.sin(angle))
        panels.append(Panel(f"Panel {i + 1}", position, (0.0, 0.2, 0.0), (0.3, 0.3), 300.0 + 40.0 * (i % 7)))
    mesh = Mesh("Pebbles", *pebbles(5, 5, segments), plastic(0.25, 0.55, 0.3, 0.15))
    floor = Box("Floor", (0.0, -0.05, 0.0), (8.0, 0.1, 8.0), plastic(0.5, 0.5, 0.5, 0.5))
    return Studio(
        "many", "a million triangles of plastic, 60 panels", (0.0, 1.6, 3.0), (0.0, 0.2, 0.0), 45.0, [floor, mesh],
        panels,
    )


def all_studios(segments=100):
    """Returns the four studios; `segments` is the fineness of the mesh of the last."""
    return [diffuse_room(), plastic_things(), chrome_and_glass(), many_lights(segments)]


def cross(a, b):
    """Returns the cross product."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def normalized(v):
    """Returns the vector at unit length."""
    length = math.sqrt(sum(x * x for x in v))
    return tuple(x / length for x in v)
