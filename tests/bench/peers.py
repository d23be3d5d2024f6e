#!/usr/bin/env python3
"""Compares renders of Aerosol with those of Mitsuba 3, block by block.

    python3 -m venv venv && venv/bin/pip install mitsuba numpy
    venv/bin/python tests/bench/peers.py --aerosol .build/release/bin/aerosol [NAME ...] [--scene FILE.xml ...]

Each scene is rendered with several seeds by both programs. Of every block of pixels the mean over the seeds has a
standard error; z is the difference of the two means by the standard error of the difference. Equal images give z with
mean 0 and deviation 1. A scene differs when the mean image does by more than --tolerance and by more than 4 standard
errors, or when a block does by more than 5 standard errors and twice the tolerance of its value.

Without names all scenes are rendered: those below, a ball of each material on a chequered ground below an area light,
and those of the folder peers beside this file, written as exporters and public collections write theirs.
"""
import argparse
import os
import subprocess
import sys
import tempfile

import numpy as np

SCENE = """<scene version="3.0.0">
  <integrator type="path"><integer name="max_depth" value="{depth}"/></integrator>
  <sensor type="perspective">
    <float name="fov" value="35"/>
    <transform name="to_world"><lookat origin="0,2.2,-5.5" target="0,0.8,0" up="0,1,0"/></transform>
    <film type="hdrfilm"><integer name="width" value="{size}"/><integer name="height" value="{size}"/>
      <rfilter type="box"/></film>
    <sampler type="independent"><integer name="sample_count" value="{spp}"/></sampler>
  </sensor>
  {light}
  <shape type="rectangle">
    <transform name="to_world"><scale value="6"/><rotate x="1" angle="-90"/></transform>
    <bsdf type="diffuse"><texture type="checkerboard" name="reflectance">
      <rgb name="color0" value="0.7,0.6,0.4"/><rgb name="color1" value="0.1,0.2,0.3"/>
      <transform name="to_uv"><scale x="6" y="6"/></transform></texture></bsdf>
  </shape>
  <shape type="sphere"><point name="center" x="0" y="1" z="0"/>{bsdf}</shape>
</scene>"""

AREA = """<shape type="rectangle">
    <transform name="to_world"><scale value="1.5"/><rotate x="1" angle="90"/><translate x="1.5" y="5" z="-1"/></transform>
    <emitter type="area"><rgb name="radiance" value="12"/></emitter></shape>
  <emitter type="constant"><rgb name="radiance" value="0.25,0.3,0.4"/></emitter>"""


def bsdf(kind, *values):
    return f'<bsdf type="{kind}">' + "".join(values) + "</bsdf>"


def number(name, value):
    return f'<float name="{name}" value="{value}"/>'


def text(name, value):
    return f'<string name="{name}" value="{value}"/>'


def rgb(name, value):
    return f'<rgb name="{name}" value="{value}"/>'


MATERIALS = {
    "diffuse": bsdf("diffuse", rgb("reflectance", "0.8,0.3,0.1")),
    "dielectric": bsdf("dielectric"),
    "dielectric_water": bsdf("dielectric", text("int_ior", "water"), text("ext_ior", "air")),
    "thindielectric": bsdf("thindielectric", number("int_ior", 1.8)),
    "roughdielectric_beckmann": bsdf("roughdielectric", number("alpha", 0.2)),
    "roughdielectric_ggx": bsdf("roughdielectric", number("alpha", 0.4), text("distribution", "ggx")),
    "conductor_gold": bsdf("conductor", text("material", "Au")),
    "conductor_rgb": bsdf("conductor", rgb("eta", "0.2,0.9,1.1"), rgb("k", "3.9,2.4,2.2")),
    "roughconductor_beckmann": bsdf("roughconductor", text("material", "Al"), number("alpha", 0.3)),
    "roughconductor_ggx": bsdf("roughconductor", text("material", "Cu"), number("alpha", 0.5), text("distribution", "ggx")),
    "roughconductor_anisotropic": bsdf("roughconductor", number("alpha_u", 0.1), number("alpha_v", 0.5), text("distribution", "ggx")),
    "plastic": bsdf("plastic", rgb("diffuse_reflectance", "0.1,0.3,0.7")),
    "plastic_nonlinear": bsdf("plastic", rgb("diffuse_reflectance", "0.7,0.4,0.1"), '<boolean name="nonlinear" value="true"/>', number("int_ior", 1.9)),
    "roughplastic": bsdf("roughplastic", rgb("diffuse_reflectance", "0.7,0.2,0.2"), number("alpha", 0.25)),
    "roughplastic_ggx": bsdf("roughplastic", rgb("diffuse_reflectance", "0.2,0.5,0.2"), number("alpha", 0.5), text("distribution", "ggx"), '<boolean name="nonlinear" value="true"/>'),
    "principled": bsdf("principled", rgb("base_color", "0.8,0.2,0.1"), number("roughness", 0.4), number("specular", 0.7), number("clearcoat", 0.8), number("clearcoat_gloss", 0.6)),
    "principled_metal": bsdf("principled", rgb("base_color", "0.9,0.6,0.2"), number("metallic", 0.9), number("roughness", 0.35), number("anisotropic", 0.7)),
    "principled_cloth": bsdf("principled", rgb("base_color", "0.2,0.3,0.8"), number("sheen", 0.9), number("sheen_tint", 0.6), number("flatness", 0.5), number("spec_tint", 0.5), number("roughness", 0.8)),
    "principled_glass": bsdf("principled", rgb("base_color", "0.8,0.9,0.7"), number("spec_trans", 0.9), number("roughness", 0.3), number("eta", 1.4)),
    "principledthin": bsdf("principledthin", rgb("base_color", "0.7,0.3,0.1"), number("spec_trans", 0.5), number("diff_trans", 0.8), number("roughness", 0.4), number("spec_tint", 0.3), number("sheen", 0.3), number("flatness", 0.3)),
    "pplastic": bsdf("pplastic", rgb("diffuse_reflectance", "0.6,0.3,0.2"), number("alpha", 0.2), number("int_ior", 1.7)),
    "conductor_palik": bsdf("roughconductor", text("material", "Ni_palik"), number("alpha", 0.2)),
    "twosided": bsdf("twosided", bsdf("roughconductor", text("material", "Ag"))),
    "mask": bsdf("mask", number("opacity", 0.4), bsdf("twosided", bsdf("diffuse", rgb("reflectance", "0.9,0.1,0.1")))),
    "blendbsdf": bsdf("blendbsdf", number("weight", 0.3), bsdf("diffuse", rgb("reflectance", "0.1,0.8,0.1")), bsdf("roughconductor", number("alpha", 0.2))),
    "blend_textured": bsdf("blendbsdf", '<texture name="weight" type="checkerboard"><float name="color0" value="0.9"/><float name="color1" value="0.1"/><transform name="to_uv"><scale x="8" y="4"/></transform></texture>', bsdf("diffuse"), bsdf("conductor")),
    "bitmap": bsdf("diffuse", '<texture name="reflectance" type="bitmap"><string name="filename" value="{folder}/colors.png"/><transform name="to_uv"><scale x="3" y="2"/></transform></texture>'),
    "bitmap_mirror": bsdf("diffuse", '<texture name="reflectance" type="bitmap"><string name="filename" value="{folder}/colors.png"/><string name="wrap_mode" value="mirror"/><string name="filter_type" value="nearest"/><transform name="to_uv"><scale x="3" y="2"/></transform></texture>'),
    "roughness_map": bsdf("roughconductor", '<texture name="alpha" type="bitmap"><string name="filename" value="{folder}/colors.png"/><boolean name="raw" value="true"/></texture>'),
    "bumpmap": bsdf("bumpmap", '<texture name="arbitrary" type="bitmap"><string name="filename" value="{folder}/bumps.png"/><boolean name="raw" value="true"/></texture>', number("scale", 0.3), bsdf("roughplastic")),
    "normalmap": bsdf("normalmap", '<texture name="normalmap" type="bitmap"><string name="filename" value="{folder}/normals.png"/><boolean name="raw" value="true"/></texture>', bsdf("roughconductor", number("alpha", 0.3))),
}

LIGHTS = {
    "light_envmap": '<emitter type="envmap"><string name="filename" value="{folder}/sky.exr"/><float name="scale" value="0.7"/><transform name="to_world"><rotate y="1" angle="40"/></transform></emitter>',
    "light_envmap_tilted": '<emitter type="envmap"><string name="filename" value="{folder}/sky.exr"/><transform name="to_world"><rotate x="1" angle="30"/><rotate y="1" angle="-100"/></transform></emitter>',
    "light_spot": '<emitter type="spot"><rgb name="intensity" value="60,50,40"/><float name="cutoff_angle" value="25"/><transform name="to_world"><lookat origin="3,5,-2" target="0,0.5,0" up="0,1,0"/></transform></emitter>',
    "light_spot_beam": '<emitter type="spot"><rgb name="intensity" value="60"/><float name="cutoff_angle" value="30"/><float name="beam_width" value="10"/><texture name="texture" type="bitmap"><string name="filename" value="{folder}/colors.png"/></texture><transform name="to_world"><lookat origin="-2,5,-2" target="0,0.5,0" up="0,1,0"/></transform></emitter>',
    "light_projector": '<emitter type="projector"><texture name="irradiance" type="bitmap"><string name="filename" value="{folder}/colors.png"/></texture><float name="scale" value="20"/><float name="fov" value="40"/><transform name="to_world"><lookat origin="-2,5,-3" target="0,0.5,0" up="0,1,0"/></transform></emitter>',
    "light_textured_area": '<shape type="rectangle"><transform name="to_world"><scale value="2"/><rotate x="1" angle="90"/><translate x="1" y="4" z="0"/></transform><emitter type="area"><texture name="radiance" type="bitmap"><string name="filename" value="{folder}/colors.png"/></texture></emitter></shape>',
    "light_point": '<emitter type="point"><point name="position" x="2" y="4" z="-2"/><rgb name="intensity" value="30"/></emitter>',
    "light_sunsky": '<emitter type="sunsky"><vector name="sun_direction" x="0.5" y="0.8" z="-0.4"/><transform name="to_world"><rotate x="1" angle="-90"/></transform></emitter>',
    "light_sunsky_low": '<emitter type="sunsky"><float name="turbidity" value="6.3"/><rgb name="albedo" value="0.1,0.6,0.9"/><vector name="sun_direction" x="0.8" y="0.15" z="-0.6"/><float name="sun_aperture" value="4"/><transform name="to_world"><rotate x="1" angle="-90"/></transform></emitter>',
    "light_sunsky_high": '<emitter type="sunsky"><float name="turbidity" value="1.4"/><float name="albedo" value="0.9"/><float name="latitude" value="0"/><float name="longitude" value="10"/><float name="timezone" value="0"/><float name="hour" value="11"/><boolean name="complex_sun" value="true"/><float name="sun_scale" value="0.5"/><transform name="to_world"><rotate x="1" angle="-90"/></transform></emitter>',
    "light_sky": '<emitter type="sunsky"><float name="turbidity" value="9.5"/><float name="albedo" value="0"/><vector name="sun_direction" x="-0.3" y="0.5" z="0.6"/><float name="sun_scale" value="0"/><float name="sky_scale" value="2"/><transform name="to_world"><rotate x="1" angle="-90"/></transform></emitter>',
    "light_directional": '<emitter type="directional"><vector name="direction" x="-1" y="-2" z="1"/><rgb name="irradiance" value="2"/></emitter>',
}


FOLDER = os.path.join(os.path.dirname(os.path.abspath(__file__)), "peers")
FILES = sorted(f[:-4] for f in os.listdir(FOLDER) if f.endswith(".xml") and f != "parts.xml")


def write_images(mi, folder):
    generator = np.random.default_rng(7)
    colors = generator.uniform(0, 255, (16, 32, 3)).astype(np.uint8)
    mi.Bitmap(colors).write(f"{folder}/colors.png")
    y, x = np.mgrid[0:64, 0:128]
    bumps = (127 + 120 * np.sin(x * 2 * np.pi / 16) * np.sin(y * 2 * np.pi / 16)).astype(np.uint8)
    mi.Bitmap(bumps[..., None]).write(f"{folder}/bumps.png")
    slope = 0.5 * np.cos(x * 2 * np.pi / 16)
    normals = np.stack([-slope, np.zeros_like(slope), np.ones_like(slope)], -1)
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    mi.Bitmap((127.5 + 127.5 * normals).round().astype(np.uint8)).write(f"{folder}/normals.png")
    v, u = np.mgrid[0:32, 0:64]
    sky = np.stack([0.2 + 0.3 * v / 32, 0.3 + 0.2 * v / 32, 0.6 - 0.3 * v / 32], -1).astype(np.float32)
    sky[6:8, 20:23] = (60, 50, 30)
    mi.Bitmap(sky).write(f"{folder}/sky.exr")


def blocks(image, side):
    h, w = (image.shape[0] // side) * side, (image.shape[1] // side) * side
    parts = image[:h, :w, :3].reshape(h // side, side, w // side, side, 3)
    return parts.mean(axis=(1, 3))


def peer_images(mi, xml, seeds):
    scene = mi.load_file(xml)
    return [np.array(mi.render(scene, seed=seed))[..., :3] for seed in range(1, seeds + 1)]


def own_images(mi, program, xml, seeds, folder):
    images = []
    for seed in range(1, seeds + 1):
        name = f"{folder}/own{seed}.exr"
        run = subprocess.run([program, "render", xml, "-o", name, "--seed", str(seed), "--quiet"], capture_output=True, text=True)
        if run.returncode != 0:
            raise RuntimeError(run.stderr.strip())
        images.append(np.array(mi.Bitmap(name).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32)))
        last = run.stderr.strip()
    return images, last


def compare(name, own, peer, side, tolerance):
    a, b = np.array([blocks(i, side) for i in own]), np.array([blocks(i, side) for i in peer])
    # Neighbouring blocks share the estimate of the variance, which few seeds give poorly.
    variance = a.var(0, ddof=1) / len(own) + b.var(0, ddof=1) / len(peer)
    padded = np.pad(variance, ((1, 1), (1, 1), (0, 0)), mode="edge")
    smooth = sum(padded[i : i + variance.shape[0], j : j + variance.shape[1]] for i in range(3) for j in range(3)) / 9
    error = np.sqrt(smooth) + 1e-4 * b.mean() + 1e-9
    difference = a.mean(0) - b.mean(0)
    z = difference / error
    ma, mb = a.mean(), b.mean()
    spread = np.sqrt(a.mean((1, 2, 3)).var(ddof=1) / len(own) + b.mean((1, 2, 3)).var(ddof=1) / len(peer))
    relative = np.abs(difference) / (b.mean(0) + 0.02 * mb)
    bad = (np.abs(z) > 5) & (relative > 2 * tolerance)
    differs = (abs(ma - mb) > tolerance * mb and abs(ma - mb) > 4 * spread) or bad.any()
    print(f"{'DIFFERS' if differs else 'same   '} {name:28} mean {ma:.4f} | {mb:.4f} ({(ma / mb - 1) * 100:+.2f}%, {(ma - mb) / (spread + 1e-12):+.1f} s.e.)  "
          f"z {z.mean():+.2f} ± {z.std():.2f}, worst {np.abs(z).max():.1f}, blocks off {bad.sum()}", flush=True)
    return not differs


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("names", nargs="*", help="scenes of this file; none: all, unless --scene is given")
    arguments.add_argument("--aerosol", default=".build/release/bin/aerosol", help="the program")
    arguments.add_argument("--scene", action="append", default=[], help="a scene file that both read")
    arguments.add_argument("--variant", default="llvm_ad_rgb", help="of Mitsuba")
    arguments.add_argument("--spp", type=int, default=64)
    arguments.add_argument("--seeds", type=int, default=6)
    arguments.add_argument("--size", type=int, default=96, help="pixels of a side")
    arguments.add_argument("--block", type=int, default=8, help="pixels of a block's side")
    arguments.add_argument("--tolerance", type=float, default=0.01, help="relative difference that counts")
    arguments.add_argument("--keep", help="folder for images")
    arguments.add_argument("--list", action="store_true", help="names of the scenes")
    options = arguments.parse_args()
    if options.list:
        print("\n".join([*MATERIALS, *LIGHTS, *FILES]))
        return 0
    import mitsuba as mi

    try:
        mi.set_variant(options.variant)
        mi.Float(1) + 1
    except Exception:
        mi.set_variant("scalar_rgb")
    mi.set_log_level(mi.LogLevel.Error)
    folder = options.keep or tempfile.mkdtemp()
    os.makedirs(folder, exist_ok=True)
    write_images(mi, folder)
    files = {os.path.basename(f): f for f in options.scene}
    for name in options.names or ([] if options.scene else [*MATERIALS, *LIGHTS, *FILES]):
        if name in FILES:
            files[name] = f"{FOLDER}/{name}.xml"
            continue
        isLight = name in LIGHTS
        if not isLight and name not in MATERIALS:
            print(f"there is no scene '{name}'; --list shows all", file=sys.stderr)
            return 2
        content = SCENE.format(depth=8, size=options.size, spp=options.spp,
                               light=LIGHTS[name] if isLight else AREA,
                               bsdf=MATERIALS["diffuse"] if isLight else MATERIALS[name]).replace("{folder}", folder)
        files[name] = f"{folder}/{name}.xml"
        with open(files[name], "w") as file:
            file.write(content)
    good = True
    for name, file in files.items():
        try:
            own, messages = own_images(mi, options.aerosol, file, options.seeds, folder)
            if messages:
                print(messages)
            peer = peer_images(mi, file, options.seeds)
            if options.keep:
                mi.Bitmap(np.concatenate([np.mean(own, 0), np.mean(peer, 0)], 1).astype(np.float32)).convert(
                    mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.UInt8, True).write(f"{folder}/{name}.png")
            good = compare(name, own, peer, options.block, options.tolerance) and good
        except Exception as error:
            print(f"FAILED  {name}: {error}", flush=True)
            good = False
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
