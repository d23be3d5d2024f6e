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


def trefoil(t):
    a = 2 * math.pi * t
    return ((math.sin(a) + 2 * math.sin(2 * a)) / 3, -math.sin(3 * a) / 3, (math.cos(a) - 2 * math.cos(2 * a)) / 3)


write_ply("knot.ply", *tube(trefoil, 0.22, 72, 10))
