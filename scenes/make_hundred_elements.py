#!/usr/bin/env python3
"""Writes hundred_elements.xml: 120 volume primitives that overlap, scripted ones and ones that read a voxel grid."""

import math
import os
import random

HEAD = """<!-- An eruption of 120 elements: 64 scripted puffs in a column and its head, 26 wisps around them, 20 clouds from a voxel file
     along the ground, 10 balls of haze. They overlap by the dozen; wherever they do, their coefficients add. How the spans
     of a ray are found is chosen by how many of them overlap (integrator: overlap). make_hundred_elements.py writes this
     file.

     aerosol render scenes/hundred_elements.xml -o hundred_elements.png -->
<scene version="3.0.0">
    <default name="spp" value="32"/>
    <integrator type="path">
        <integer name="max_depth" value="24"/>
        <string name="overlap" value="auto"/>
    </integrator>
    <sensor type="perspective">
        <transform name="to_world">
            <lookat origin="0, 1.7, -13" target="0, 2.75, 0" up="0, 1, 0"/>
        </transform>
        <float name="fov" value="40"/>
        <film type="hdrfilm">
            <integer name="width" value="400"/>
            <integer name="height" value="300"/>
        </film>
        <sampler type="sobol">
            <integer name="sample_count" value="$spp"/>
        </sampler>
    </sensor>
    <emitter type="constant">
        <rgb name="radiance" value="0.35, 0.45, 0.65"/>
    </emitter>
    <emitter type="directional">
        <vector name="direction" x="1" y="-0.8" z="0.6"/>
        <rgb name="irradiance" value="5, 4.5, 3.8"/>
    </emitter>
    <shape type="rectangle">
        <transform name="to_world">
            <rotate x="1" angle="-90"/>
            <scale value="80"/>
        </transform>
        <bsdf type="diffuse">
            <rgb name="reflectance" value="0.22, 0.2, 0.18"/>
        </bsdf>
    </shape>
"""


def element(kind, x, y, z, size, turn, medium):
    inside = '<string name="filename" value="cloud.vdb"/>' if kind == "grid" else ""
    return (f'    <volume type="{kind}">{inside}<transform name="to_world"><scale value="{size:.3f}"/>'
            f'<rotate y="1" angle="{turn:.0f}"/><translate x="{x:.3f}" y="{y:.3f}" z="{z:.3f}"/></transform>\n'
            f'        {medium}</volume>\n')


def ash(rng, shade):
    seed = ", ".join(f"{rng.uniform(-20, 20):.2f}" for _ in range(3))
    return (f'<medium type="pyroclastic"><rgb name="albedo" value="{shade:.3f}, {shade * 0.97:.3f}, {shade * 0.94:.3f}"/>'
            f'<float name="density" value="{rng.uniform(5, 14):.1f}"/><point name="seed" value="{seed}"/>'
            f'<integer name="octaves" value="4"/></medium>')


def wisp(rng):
    seed = ", ".join(f"{rng.uniform(-20, 20):.2f}" for _ in range(3))
    return f'<medium type="wisps"><float name="density" value="3"/><point name="seed" value="{seed}"/></medium>'


def main():
    rng = random.Random(4)
    lines = [HEAD]
    for i in range(40):  # The column.
        t = i / 39
        angle = 2.4 * i
        radius = 0.18 + 0.35 * t
        lines.append(element("sphere", radius * math.cos(angle), 0.3 + 3.6 * t, radius * math.sin(angle),
                             0.55 + 0.5 * t + rng.uniform(0, 0.15), 0, ash(rng, 0.62 + 0.25 * t)))
    for i in range(24):  # The head.
        angle = 2.399963 * i
        radius = 2.2 * math.sqrt((i + 0.5) / 24)
        lines.append(element("sphere", radius * math.cos(angle), 4.35 + rng.uniform(-0.3, 0.45), radius * math.sin(angle),
                             rng.uniform(0.75, 1.05), 0, ash(rng, 0.9)))
    for i in range(26):
        angle = rng.uniform(0, 2 * math.pi)
        radius = rng.uniform(0.8, 2.8)
        lines.append(element("sphere", radius * math.cos(angle), rng.uniform(0.8, 4.8), radius * math.sin(angle),
                             rng.uniform(0.7, 1.2), 0, wisp(rng)))
    for i in range(20):
        angle = 2 * math.pi * (i + rng.uniform(0, 0.7)) / 20
        radius = rng.uniform(1.6, 3.4)
        lines.append(element("grid", radius * math.cos(angle), 0.3, radius * math.sin(angle), rng.uniform(0.8, 1.3),
                             rng.uniform(0, 360), '<ref id="surge"/>' if i else
                             '<medium type="grid" id="surge"><string name="filename" value="cloud.vdb"/>'
                             '<float name="density" value="8"/><rgb name="albedo" value="0.75, 0.7, 0.64"/></medium>'))
    for i in range(10):
        angle = 2 * math.pi * i / 10
        lines.append(element("sphere", 2.5 * math.cos(angle), 1.2, 2.5 * math.sin(angle), 2.4, 0,
                             '<ref id="haze"/>' if i else
                             '<medium type="homogeneous" id="haze"><rgb name="sigma_t" value="0.02"/>'
                             '<rgb name="albedo" value="0.9"/></medium>'))
    lines.append("</scene>\n")
    with open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "hundred_elements.xml"), "w") as file:
        file.write("".join(lines))


if __name__ == "__main__":
    main()
