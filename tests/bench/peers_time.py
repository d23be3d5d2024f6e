#!/usr/bin/env python3
"""Error times processor time of Aerosol and of Mitsuba 3, on volume scenes that both read.

    python3 -m venv venv && venv/bin/pip install mitsuba numpy
    venv/bin/python tests/bench/peers_time.py --aerosol .build/release/bin/aerosol [NAME ...] [-o FILE.json]

Of each scene both make half of a reference, which are compared (their difference is printed with its standard error) and
joined. Then both render it for about the same processor time with several seeds. The error is the squared
difference to the reference over the squared mean of the image; the reference's own variance is taken off. The ratio is
Mitsuba's (error x time) over Aerosol's: above 1 Aerosol is better. Its spread is that of the quartiles over pairs of
seeds.

Mitsuba runs as volpath and as volpathmis, as scalar_rgb and as llvm_ad_rgb, and the one with the least error x time counts
(path where a scene has no media). Its time is that of the render call alone: loading is left out, and so is the
compilation of kernels, by rendering the same once before. Aerosol's time is that of the whole process: start, loading,
compilation of shaders (from the cache of compiled code where it is there) and preparation.
"""
import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
import time

import numpy as np

SENSOR = """<sensor type="perspective"><float name="fov" value="{fov}"/>
    <transform name="to_world"><lookat origin="{eye}" target="{target}" up="0,1,0"/></transform>
    <film type="hdrfilm"><integer name="width" value="{width}"/><integer name="height" value="{height}"/>
      <rfilter type="box"/><string name="pixel_format" value="rgb"/></film>
    <sampler type="independent"><integer name="sample_count" value="{spp}"/></sampler></sensor>"""
SUN = """<emitter type="constant"><rgb name="radiance" value="0.3, 0.4, 0.6"/></emitter>
  <emitter type="directional"><vector name="direction" x="-0.6" y="-1" z="0.3"/>
    <rgb name="irradiance" value="4, 3.7, 3.2"/></emitter>"""
# Below the boxes: of two faces in one place either renderer may meet the other one first.
GROUND = """<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/><scale value="6"/>
    <translate y="-1.02"/></transform><bsdf type="diffuse"><rgb name="reflectance" value="0.5, 0.45, 0.4"/></bsdf></shape>"""


def box(medium, scale="1", turn="0"):
    return f"""<shape type="cube"><transform name="to_world"><scale value="{scale}"/><rotate y="1" angle="{turn}"/></transform>
    <bsdf type="null"/><medium name="interior" {medium}</medium></shape>"""


def voxels(albedo, scale, phase=0.6):
    return f"""type="heterogeneous"><volume name="sigma_t" type="gridvolume"><string name="filename" value="cloud.vol"/>
      <transform name="to_world"><translate x="-0.5" y="-0.5" z="-0.5"/><scale value="2"/></transform></volume>
      <rgb name="albedo" value="{albedo}"/><float name="scale" value="{scale}"/>
      <phase type="hg"><float name="g" value="{phase}"/></phase>"""


HOMOGENEOUS = """type="homogeneous"><rgb name="sigma_t" value="{}"/><float name="scale" value="{}"/>
    <rgb name="albedo" value="{}"/><phase type="isotropic"></phase>"""

# name: (max_depth, hide_emitters, fov, eye, content)
SCENES = {
    "lamp_in_fog": (16, True, 26, "0,0,-5", """<shape type="sphere"><point name="center" x="0.1" y="0.3" z="-0.2"/>
      <float name="radius" value="0.02"/><bsdf type="diffuse"/>
      <emitter type="area"><rgb name="radiance" value="1500"/></emitter></shape>"""
                    + box(HOMOGENEOUS.format("0.5", 3, "0.8"), 0.9, 25)),
    "dense_cloud": (100, False, 26, "0,0,-5", SUN + box(voxels("0.999", 40))),
    "thin_smoke": (16, False, 32, "0,0.4,-5", SUN + GROUND + box(voxels("0.7, 0.75, 0.8", 4, 0.3))),
    "smoke_and_area_light": (16, False, 32, "0,0.4,-5", GROUND + """<shape type="rectangle"><transform name="to_world">
      <scale value="0.5"/><rotate x="1" angle="90"/><translate x="0.8" y="2.2" z="-0.4"/></transform>
      <bsdf type="diffuse"/><emitter type="area"><rgb name="radiance" value="20"/></emitter></shape>"""
                             + box(voxels("0.9", 8, 0.3))),
    "subsurface_slab": (100, False, 26, "0,0,-5", """<emitter type="constant"><rgb name="radiance" value="0.4"/></emitter>
      <emitter type="point"><point name="position" x="1" y="1.5" z="-2.5"/><rgb name="intensity" value="12"/></emitter>
      <shape type="cube"><transform name="to_world"><scale x="0.9" y="0.6" z="0.25"/><rotate y="1" angle="25"/></transform>
      <bsdf type="null"/><medium name="interior" """
                        + HOMOGENEOUS.format("0.15, 0.45, 1", 40, "0.998, 0.98, 0.9") + "</medium></shape>"),
    "spot_in_mist": (8, False, 40, "0,0.5,-5", GROUND + """<emitter type="spot"><transform name="to_world">
      <lookat origin="-1.5,1.4,0.2" target="0.8,-0.8,0" up="0,1,0"/></transform><rgb name="intensity" value="40"/>
      <float name="cutoff_angle" value="18"/></emitter>"""
                     + box(HOMOGENEOUS.format("0.25", 1, "0.9"), 1.9)),
}


def write_cloud(mi, folder, side=96):
    """A ball whose surface is folded by a few octaves of waves; zero outside."""
    z, y, x = (np.mgrid[0:side, 0:side, 0:side] + 0.5) / side * 2 - 1
    generator = np.random.default_rng(11)
    noise, amplitude = np.zeros((side,) * 3), 1.0
    for octave in range(5):
        for _ in range(6):
            k = generator.normal(size=3)
            k *= 3.0 * 2**octave / np.linalg.norm(k)
            noise += amplitude * np.sin(k[0] * x + k[1] * y + k[2] * z + generator.uniform(0, 6.3)) / 6
        amplitude *= 0.6
    density = np.clip((0.75 - np.sqrt(x * x + 1.4 * y * y + z * z) + 0.35 * noise) / 0.15, 0, 1)
    mi.VolumeGrid(density[..., None].astype(np.float32)).write(f"{folder}/cloud.vol")


def scene_file(folder, name, integrator, size, spp=16):
    depth, hides, fov, eye, content = SCENES[name]
    sensor = SENSOR.format(fov=fov, eye=eye, target="0,0,0", width=size, height=size * 3 // 4, spp=spp)
    path = f"{folder}/{name}_{integrator}.xml"
    with open(path, "w") as file:
        file.write(f"""<scene version="3.0.0"><integrator type="{integrator}">
  <integer name="max_depth" value="{depth}"/><integer name="rr_depth" value="5"/>
  <boolean name="hide_emitters" value="{str(hides).lower()}"/></integrator>{sensor}{content}</scene>""")
    return path


class Own:
    name = "Aerosol"

    def __init__(self, mi, program, path, folder):
        self.mi, self.command, self.image = mi, [program, "render", path, "--threads", "1", "--quiet"], f"{folder}/own.exr"

    def render(self, spp, seed):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        run = subprocess.run([*self.command, "--spp", str(spp), "--seed", str(seed), "-o", self.image], capture_output=True, text=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        if run.returncode != 0:
            raise RuntimeError(run.stderr.strip())
        bitmap = self.mi.Bitmap(self.image).convert(self.mi.Bitmap.PixelFormat.RGB, self.mi.Struct.Type.Float32)
        return np.array(bitmap, dtype=np.float64), after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


class Peer:
    """Mitsuba in a process of its own: its variants do not share one."""

    def __init__(self, mi, variant, path, integrator, folder):
        self.name = f"Mitsuba {integrator} {variant}"
        self.image = f"{folder}/{variant}_{integrator}.npy"
        self.process = subprocess.Popen([sys.executable, __file__, "--serve", variant, path, self.image], text=True,
                                        stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        ready = self.process.stdout.readline().strip()
        if ready != "ready":
            raise RuntimeError(ready or "ended")

    def render(self, spp, seed):
        self.process.stdin.write(f"{spp} {seed}\n")
        self.process.stdin.flush()
        taken = float(self.process.stdout.readline())
        return np.load(self.image), taken

    def stop(self):
        self.process.stdin.close()
        self.process.wait()


def serve(variant, path, image):
    """Renders with `spp seed` of each line of standard input; answers with the processor time."""
    import mitsuba as mi

    try:
        mi.set_variant(variant)
        mi.set_log_level(mi.LogLevel.Error)
        scene = mi.load_file(path)
    except Exception as error:
        print(str(error).splitlines()[0], flush=True)
        return 1
    print("ready", flush=True)
    known = set()
    for line in sys.stdin:
        spp, seed = map(int, line.split())
        if spp not in known and "llvm" in variant:
            np.array(mi.render(scene, spp=spp, seed=seed))
            known.add(spp)
        start = time.process_time()
        pixels = np.array(mi.render(scene, spp=spp, seed=seed))[..., :3]
        taken = time.process_time() - start
        np.save(image, pixels.astype(np.float64))
        print(taken, flush=True)
    return 0


def samples_for(renderer, seconds):
    spp = 4
    _, taken = renderer.render(spp, 1)
    while taken < 0.2 * seconds and spp < 1 << 16:
        spp *= 4
        _, taken = renderer.render(spp, 1)
    return max(2, int(spp * seconds / max(taken, 1e-3)))


def reference(renderer, seconds, parts=8):
    """Mean over `parts` seeds, and its variance, pixel by pixel."""
    spp = samples_for(renderer, seconds / parts)
    images = np.array([renderer.render(spp, 1000 + i)[0] for i in range(parts)])
    return images.mean(0), images.var(0, ddof=1) / parts


def measure(renderer, seconds, seeds, truth, variance):
    spp = samples_for(renderer, seconds)
    costs, means = [], []
    for seed in range(1, seeds + 1):
        image, taken = renderer.render(spp, seed)
        error = ((image - truth) ** 2 - variance).mean() / truth.mean() ** 2
        costs.append(max(error, 1e-12) * taken)
        means.append(image.mean())
    means = np.array(means)
    return {"method": renderer.name, "samples": spp, "costs": costs, "mean": means.mean(),
            "meanError": means.std(ddof=1) / np.sqrt(seeds)}


def quartiles(ours, theirs):
    ratios = np.divide.outer(np.array(theirs), np.array(ours)).ravel()
    return np.percentile(ratios, [25, 50, 75])


def run_scene(mi, name, options, folder):
    own = Own(mi, options.aerosol, scene_file(folder, name, "volpath", options.size), folder)
    peers = []
    for variant in ("scalar_rgb", "llvm_ad_rgb"):
        for integrator in ("volpath", "volpathmis"):
            try:
                peers.append(Peer(mi, variant, scene_file(folder, name, integrator, options.size), integrator, folder))
            except Exception as error:  # This build of Mitsuba may lack LLVM.
                print(f"  {variant} {integrator}: {str(error).splitlines()[0]}")
    fastest = {}
    first, first_variance = reference(own, options.reference)
    for peer in peers:
        fastest[peer.name] = measure(peer, options.seconds, 3, first, first_variance)
    best = min(peers, key=lambda p: np.median(fastest[p.name]["costs"]))
    second, second_variance = reference(best, options.reference)
    weight = second_variance.mean() / (first_variance.mean() + second_variance.mean() + 1e-30)
    truth = weight * first + (1 - weight) * second
    variance = weight**2 * first_variance + (1 - weight) ** 2 * second_variance
    pixels = first.size
    apart = (first.mean() - second.mean()) / second.mean()
    apart_error = np.sqrt((first_variance.mean() + second_variance.mean()) / pixels) / second.mean()
    ours = measure(own, options.seconds, options.seeds, truth, variance)
    theirs = measure(best, options.seconds, options.seeds, truth, variance)
    for peer in peers:
        peer.stop()
    low, median, high = quartiles(ours["costs"], theirs["costs"])
    print(f"{name:22} {median:8.2f} ({low:.2f} to {high:.2f})   references differ by {100 * apart:+.3f} % ± {100 * apart_error:.3f}   "
          f"{best.name}, {theirs['samples']} | {ours['samples']} samples", flush=True)
    for method, result in fastest.items():
        print(f"  {method:34} error x time {np.median(result['costs']):.3g}")
    print(f"  {'Aerosol':34} error x time {np.median(ours['costs']):.3g}", flush=True)
    return {"scene": name, "ratio": median, "lower": low, "upper": high, "difference": apart, "differenceError": apart_error,
            "own": ours, "peer": theirs}


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("names", nargs="*", help="scenes; none: all")
    arguments.add_argument("--aerosol", default=".build/release/bin/aerosol", help="the program")
    arguments.add_argument("--seconds", type=float, default=8, help="processor time of a render")
    arguments.add_argument("--reference", type=float, default=60, help="processor time of each half of the reference")
    arguments.add_argument("--seeds", type=int, default=8)
    arguments.add_argument("--size", type=int, default=64, help="width in pixels")
    arguments.add_argument("--list", action="store_true", help="names of the scenes")
    arguments.add_argument("-o", help="writes the measurements as JSON")
    arguments.add_argument("--serve", nargs=3, help=argparse.SUPPRESS)
    options = arguments.parse_args()
    if options.serve:
        return serve(*options.serve)
    if options.list:
        print("\n".join(SCENES))
        return 0
    unknown = [n for n in options.names if n not in SCENES]
    if unknown:
        print(f"there is no scene '{unknown[0]}'; --list shows all", file=sys.stderr)
        return 2
    import mitsuba as mi

    mi.set_variant("scalar_rgb")
    mi.set_log_level(mi.LogLevel.Error)
    folder = tempfile.mkdtemp()
    write_cloud(mi, folder)
    results = [run_scene(mi, name, options, folder) for name in options.names or SCENES]
    print(f"median of the ratios: {np.median([r['ratio'] for r in results]):.2f}")
    if options.o:
        with open(options.o, "w") as file:
            json.dump(results, file, indent=1)
    return 0


if __name__ == "__main__":
    sys.exit(main())
