"""Renders the scenes of `lovelock bench reference` with Mitsuba 3.

Arguments: the folder with scenes.json, a folder for the results, samples per pixel (even). Writes NAME.a.f32 and NAME.b.f32 per
scene, each of half of the samples: red, green, blue and coverage per pixel as little-endian f32, rows from the top, linear light
without tone mapping. Images whose scene, strands and samples are those of an earlier run are kept. Standard output gets one JSON
object: what was rendered, and the furnace.

Each image is rendered by a process of its own: Mitsuba 3.9.1 was seen to die while it read the segments of a B-spline curve, and
always at the same image when it had rendered others before. An image whose process dies is rendered with other random numbers.
"""

import hashlib
import json
import subprocess
import sys
import time
from pathlib import Path

import mitsuba as mi
import numpy as np

mi.set_variant("scalar_rgb")

# White hair scatters light hundreds of times before it leaves.
MOST_BOUNCES = 4000
# Early roulette has the same mean, and for equal time 3 to 5 times less variance than after 60 bounces: most long paths are dark.
ROULETTE_AFTER = 4
# In the furnace, fibres that absorb nothing are invisible; those of the control are not. Paths are all equally bright there, and
# roulette would only make a few of them very bright.
FURNACE_LIMIT = 0.02
FURNACE_INTEGRATOR = {"rr_depth": MOST_BOUNCES, "hide_emitters": True}
CONTROL_SIGMA = 0.1
FURNACE_SIZE = 48
FURNACE_SAMPLES = 32
# So often an image is tried with other random numbers.
MOST_DEATHS = 5


def hair(folder, scene, strands_file, sigma_a):
    fibre = scene["fibre"]
    return {
        "type": "bsplinecurve",
        "filename": str(folder / strands_file),
        "bsdf": {
            "type": "hair",
            "sigma_a": {"type": "rgb", "value": sigma_a},
            "longitudinal_roughness": fibre["longitudinal_roughness"],
            "azimuthal_roughness": fibre["azimuthal_roughness"],
            "scale_tilt": fibre["scale_tilt_degrees"],
            "int_ior": fibre["index"],
        },
    }


def strands_files(scene):
    """The files of the strands with pigment and, of grey hair, of those without."""
    return [scene[key] for key in ("strands_file", "white_strands_file") if key in scene]


def absorptions(scene):
    """Absorption of the strands of each file."""
    return [scene["fibre"][key] for key in ("sigma_a", "white_sigma_a") if key in scene["fibre"]]


def setup(folder, scene, size, sigmas, emitter, **integrator):
    camera = scene["camera"]
    files = strands_files(scene)
    parts = {f"hair{i}": hair(folder, scene, files[i], sigma) for i, sigma in enumerate(sigmas)}
    look_at = mi.ScalarTransform4f().look_at(camera["eye"], camera["target"], camera["up"])
    return mi.load_dict(
        {
            "type": "scene",
            "integrator": {
                "type": "path",
                "max_depth": MOST_BOUNCES,
                "rr_depth": ROULETTE_AFTER,
                **integrator,
            },
            "sensor": {
                "type": "perspective",
                "fov": camera["fov_y_degrees"],
                "fov_axis": "y",
                "near_clip": 1.0,
                "far_clip": 1e5,
                "to_world": look_at,
                "sampler": {"type": "independent"},
                "film": {
                    "type": "hdrfilm",
                    "width": size[0],
                    "height": size[1],
                    "pixel_format": "rgba",
                    "component_format": "float32",
                    "rfilter": {"type": "box"},
                },
            },
            **parts,
            "light": emitter,
        }
    )


def directional(scene):
    light = scene["light"]
    return {
        "type": "directional",
        "direction": light["direction"],
        "irradiance": {"type": "rgb", "value": light["irradiance"]},
    }


def furnace(folder, scene, seed):
    """Mean radiance of the hair in light of radiance 1 from everywhere: [without absorption, of the control]."""
    means = []
    for sigma in (0.0, CONTROL_SIGMA):
        light = {"type": "constant", "radiance": 1.0}
        sigmas = [[sigma] * 3 for _ in strands_files(scene)]
        loaded = setup(folder, scene, [FURNACE_SIZE] * 2, sigmas, light, **FURNACE_INTEGRATOR)
        image = np.array(mi.render(loaded, spp=FURNACE_SAMPLES, seed=seed))
        means.append(float(image[..., :3].mean(axis=2).sum() / image[..., 3].sum()))
    return means


def render_half(folder, index, seed, samples, file):
    """Renders half of the samples of a scene. Returns the mean."""
    report = json.loads((folder / "scenes.json").read_text(encoding="utf-8"))
    scene, size = report["scenes"][index], [report["width"], report["height"]]
    loaded = setup(folder, scene, size, absorptions(scene), directional(scene))
    image = np.array(mi.render(loaded, spp=samples, seed=seed)).astype("<f4")
    if image.shape != (size[1], size[0], 4) or not np.isfinite(image).all():
        sys.exit(f"{scene['name']}: found an image of shape {image.shape} or with values that are not finite")
    image.tofile(file)
    return float(image[..., :3].mean())


def in_process(*arguments):
    """The last argument is a seed. Returns what the process printed, and how many died before it."""
    for died in range(MOST_DEATHS):
        *others, seed = arguments
        words = [str(word) for word in [*others, seed + 1_000_000 * died]]
        done = subprocess.run([sys.executable, __file__, *words], stdout=subprocess.PIPE, check=False)
        if done.returncode == 0:
            return json.loads(done.stdout), died
        # An exit status of its own and not a signal: an error that it has told.
        if done.returncode == 1:
            sys.exit(1)
    sys.exit(f"Mitsuba died {MOST_DEATHS} times at {' '.join(words)}")


def checked_furnace(folder, index, scene):
    (white, control), died = in_process("furnace", folder, index, 1)
    print(f"furnace, {scene['strands_file']}: {white:.4f}, control {control:.4f}", file=sys.stderr)
    if abs(white - 1.0) > FURNACE_LIMIT:
        sys.exit(f"furnace: found {white:.4f}; must be 1 within {FURNACE_LIMIT}")
    if not control < 1.0 - FURNACE_LIMIT:
        sys.exit(f"furnace: absorbing fibres gave {control:.4f}; must be less than {1.0 - FURNACE_LIMIT}")
    return {"strands_file": scene["strands_file"], "mean": white, "control": control, "died": died}


def key_of(folder, scene, size, samples):
    """Changes with everything that the image depends on."""
    what = {name: scene[name] for name in ("camera", "light", "fibre")}
    what.update(size=size, samples=samples, version=mi.__version__, depth=[MOST_BOUNCES, ROULETTE_AFTER])
    strands = b"".join((folder / file).read_bytes() for file in strands_files(scene))
    return hashlib.sha256(json.dumps(what, sort_keys=True).encode() + strands).hexdigest()


def main(folder, out, samples):
    out.mkdir(parents=True, exist_ok=True)
    report = json.loads((folder / "scenes.json").read_text(encoding="utf-8"))
    size = [report["width"], report["height"]]
    furnaces, rendered = [], []
    for index, scene in enumerate(report["scenes"]):
        name, key = scene["name"], key_of(folder, scene, size, samples)
        if scene["strands_file"] not in [one["strands_file"] for one in furnaces]:
            furnaces.append(checked_furnace(folder, index, scene))
        key_file = out / f"{name}.key"
        halves = [out / f"{name}.{half}.f32" for half in "ab"]
        if key_file.exists() and key_file.read_text() == key and all(half.exists() for half in halves):
            continue
        started = time.time()
        key_file.unlink(missing_ok=True)
        means, deaths = [], 0
        for half, file in enumerate(halves):
            mean, died = in_process("half", folder, index, samples // 2, file, 2 * index + half)
            means.append(mean)
            deaths += died
        key_file.write_text(key)
        seconds = time.time() - started
        again = f", rendered again {deaths} times" if deaths else ""
        print(f"{name}: {seconds:.1f} s, means {means[0]:.4f} and {means[1]:.4f}{again}", file=sys.stderr, flush=True)
        rendered.append({"name": name, "seconds": seconds, "died": deaths})
    print(json.dumps({"version": mi.__version__, "furnace": furnaces, "rendered": rendered}))


match sys.argv[1:]:
    case ["furnace", folder, index, seed]:
        scene = json.loads((Path(folder) / "scenes.json").read_text(encoding="utf-8"))["scenes"][int(index)]
        print(json.dumps(furnace(Path(folder), scene, int(seed))))
    case ["half", folder, index, samples, file, seed]:
        print(json.dumps(render_half(Path(folder), int(index), int(seed), int(samples), file)))
    case [folder, out, samples]:
        main(Path(folder), Path(out), int(samples))
    case _:
        sys.exit("arguments: FOLDER OUT SAMPLES")
