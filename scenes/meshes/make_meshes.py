#!/usr/bin/env python3
"""Writes the meshes of the scenes in this folder: `make_meshes.py` beside them."""
import math
import pathlib

FOLDER = pathlib.Path(__file__).parent


def write_ply(name, positions, triangles):
    """ASCII PLY; triangles turn counter-clockwise seen from outside."""
    with open(FOLDER / name, "w") as out:
        out.write(f"ply\nformat ascii 1.0\nelement vertex {len(positions)}\n")
        out.write("property float x\nproperty float y\nproperty float z\n")
        out.write(f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n")
        for p in positions:
            out.write(" ".join(f"{x:.4f}" for x in p) + "\n")
        for t in triangles:
            out.write("3 " + " ".join(map(str, t)) + "\n")


def tube(curve, radius, rings, sides):
    """A closed tube around a closed curve [0, 1) -> point, with a frame that turns as little as possible."""
    sub = lambda a, b: tuple(x - y for x, y in zip(a, b))
    dot = lambda a, b: sum(x * y for x, y in zip(a, b))
    cross = lambda a, b: (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])
    unit = lambda a: tuple(x / math.sqrt(dot(a, a)) for x in a)
    tangents = [unit(sub(curve((i + 0.5) / rings), curve((i - 0.5) / rings))) for i in range(rings)]
    u = unit(cross(tangents[0], (0.3, 0.5, 0.8)))
    frames = []
    for t in tangents + tangents[:1]:
        u = unit(sub(u, tuple(dot(u, t) * x for x in t)))
        frames.append((u, cross(t, u)))
    # What the frame has turned by after one round is spread over all rings.
    turn = math.atan2(dot(frames[-1][0], frames[0][1]), dot(frames[-1][0], frames[0][0]))
    positions, triangles = [], []
    for i in range(rings):
        center, (a, b) = curve(i / rings), frames[i]
        for j in range(sides):
            angle = 2 * math.pi * j / sides - turn * i / rings
            positions.append(tuple(c + radius * (math.cos(angle) * x + math.sin(angle) * y)
                                   for c, x, y in zip(center, a, b)))
            at = lambda k, l: (k % rings) * sides + l % sides
            triangles.append((at(i, j), at(i, j + 1), at(i + 1, j + 1)))
            triangles.append((at(i, j), at(i + 1, j + 1), at(i + 1, j)))
    return positions, triangles


def lathe(profile, sides):
    """A solid of revolution around y; the profile (radius, height) begins and ends on the axis and has the solid on its
    left. Each of its parts has corners of its own, so that normals are smooth around the axis and sharp across edges."""
    positions, triangles = [], []
    for (r0, y0), (r1, y1) in zip(profile, profile[1:]):
        first = len(positions)
        for i in range(sides):
            a = 2 * math.pi * i / sides
            positions.append((r0 * math.cos(a), y0, r0 * math.sin(a)))
            positions.append((r1 * math.cos(a), y1, r1 * math.sin(a)))
        for i in range(sides):
            a, b = first + 2 * i, first + 2 * ((i + 1) % sides)
            if r0 > 0:
                triangles.append((a, a + 1, b))
            if r1 > 0:
                triangles.append((b, a + 1, b + 1))
    return positions, triangles


def trefoil(t):
    a = 2 * math.pi * t
    return ((math.sin(a) + 2 * math.sin(2 * a)) / 3, -math.sin(3 * a) / 3, (math.cos(a) - 2 * math.cos(2 * a)) / 3)


write_ply("knot.ply", *tube(trefoil, 0.22, 72, 10))

# A tumbler and three liquids for it: reaching into the wall, leaving a gap, and with faces just where the wall's are.
SIDES, OUTER, INNER, BOTTOM, HEIGHT, LEVEL = 96, 0.5, 0.42, 0.12, 1.3, 0.95
write_ply("tumbler.ply", *lathe([(0, 0), (OUTER, 0), (OUTER, HEIGHT), (INNER, HEIGHT), (INNER, BOTTOM), (0, BOTTOM)], SIDES))
for name, reach in ("liquid_overlap.ply", 0.03), ("liquid_gap.ply", -0.02), ("liquid_fit.ply", 0):
    r, bottom = INNER + reach, BOTTOM - reach
    write_ply(name, *lathe([(0, bottom), (r, bottom), (r, LEVEL), (0, LEVEL)], SIDES))
