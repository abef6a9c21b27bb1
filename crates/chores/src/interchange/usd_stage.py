"""Reads the stages that Lovelock wrote with Pixar's own reader, and says what is wrong with them.

Arguments: a folder with strands.usdc, strands.usda and guides.usdc, and info.json, which is what
`lovelock info --json` said of strands.usdc. Prints a line for each fault; none where all is well.
"""

import json
import math
import sys
from pathlib import Path

from pxr import Gf, Tf, Usd, UsdGeom, UsdValidation

# The most that a point may be off, metres.
LIMIT = 1e-4


def curves_of(stage):
    return [UsdGeom.BasisCurves(prim) for prim in stage.Traverse() if prim.IsA(UsdGeom.BasisCurves)]


def points_at(stage, time):
    points = []
    for curves in curves_of(stage):
        to_world = UsdGeom.Xformable(curves).ComputeLocalToWorldTransform(time)
        points += [to_world.Transform(Gf.Vec3d(p)) for p in curves.GetPointsAttr().Get(time) or []]
    return points


def farthest(a, b):
    if len(a) != len(b):
        return math.inf
    return max(((p - q).GetLength() for p, q in zip(a, b)), default=math.inf)


def check_stage(path, frames, fps):
    """Metadata, topology, extents and what the compliance checker finds."""
    try:
        stage = Usd.Stage.Open(str(path))
    except Tf.ErrorException as error:
        return [f"cannot be opened: {error}".splitlines()[0]], None
    faults = []

    def expect(what, found, wanted):
        if found != wanted:
            faults.append(f"{what}: {found}, wanted {wanted}")

    expect("up axis", UsdGeom.GetStageUpAxis(stage), UsdGeom.Tokens.y)
    expect("metres a unit", UsdGeom.GetStageMetersPerUnit(stage), 1.0)
    expect("time codes a second", stage.GetTimeCodesPerSecond(), fps)
    expect("frames a second", stage.GetFramesPerSecond(), fps)
    expect("first time", stage.GetStartTimeCode(), frames[0])
    expect("last time", stage.GetEndTimeCode(), frames[-1])
    expect("default prim", stage.GetDefaultPrim().GetName(), "Lovelock")
    for curves in curves_of(stage):
        counts = curves.GetCurveVertexCountsAttr().Get()
        expect("times of points", curves.GetPointsAttr().GetTimeSamples(), [float(f) for f in frames])
        expect("interpolation of widths", curves.GetWidthsInterpolation(), "vertex")
        for what, values in [
            ("points", curves.GetPointsAttr().Get(frames[0])),
            ("widths", curves.GetWidthsAttr().Get()),
            ("colours", curves.GetDisplayColorAttr().Get()),
        ]:
            expect(what, len(values or []), sum(counts))
        for frame in frames:
            box = Gf.Range3f(*curves.GetExtentAttr().Get(frame))
            outside = sum(not box.Contains(p) for p in curves.GetPointsAttr().Get(frame))
            expect(f"points outside of the extent at {frame}", outside, 0)
    meshes = [UsdGeom.Mesh(prim) for prim in stage.Traverse() if prim.IsA(UsdGeom.Mesh)]
    expect("bodies", len(meshes), 1)
    for mesh in meshes:
        points, normals = mesh.GetPointsAttr().Get(frames[0]), mesh.GetNormalsAttr().Get(frames[0])
        expect("normals", len(normals), len(points))
        counts, indices = mesh.GetFaceVertexCountsAttr().Get(), mesh.GetFaceVertexIndicesAttr().Get()
        good, why = UsdGeom.Mesh.ValidateTopology(indices, counts, len(points))
        expect("topology", good or why, True)
        expect("subdivision", mesh.GetSubdivisionSchemeAttr().Get(), "none")
    checker = UsdValidation.ValidationContext(UsdValidation.ValidationRegistry().GetOrLoadAllValidators())
    faults += [error.GetErrorAsString() for error in checker.Validate(stage)]
    return faults, stage


def check_import(stage, frames, info):
    """What our own importer made of the file, held against what is in it."""
    points = points_at(stage, frames[0])
    faults = []
    strands = sum(len(curves.GetCurveVertexCountsAttr().Get()) for curves in curves_of(stage))
    if (strands, len(points)) != (info["strands"], info["points"]):
        faults.append(f"{strands} strands of {len(points)} points, and the importer found {info['strands']} of {info['points']}")
    sign = -1.0 if info["facing"][0] == "-" else 1.0
    face = Gf.Vec3d(sign, 0, 0) if info["facing"][1] == "x" else Gf.Vec3d(0, 0, sign)
    side = Gf.Cross(Gf.Vec3d(0, 1, 0), face)
    turned = [(p * side, p[1], p * face) for p in points]
    for bound, pick in [("min", min), ("max", max)]:
        for axis in range(3):
            off = abs(pick(p[axis] for p in turned) - info["bounds_m"][bound][axis])
            if off > LIMIT:
                faults.append(f"{bound} of axis {axis}: the importer is {off} m off")
    return faults


def main(folder):
    folder = Path(folder)
    request = json.loads((folder / "request.json").read_text())
    frames, fps = list(range(*request["frames"])), request["fps"]
    info = json.loads((folder / "info.json").read_text())
    stages, faults = {}, []
    for name in ["strands.usdc", "strands.usda", "guides.usdc"]:
        found, stages[name] = check_stage(folder / name, frames, fps)
        faults += [f"{name}: {fault}" for fault in found]
    if faults:
        return faults
    faults += check_import(stages["strands.usdc"], frames, info)
    for frame in frames:
        binary, text = points_at(stages["strands.usdc"], frame), points_at(stages["strands.usda"], frame)
        off = farthest(binary, text)
        if off > LIMIT:
            faults.append(f"time {frame}: text and crate are {off} m apart")
        # Controls: another frame is another place.
        if frame != frames[0] and farthest(binary, points_at(stages["strands.usdc"], frames[0])) <= LIMIT:
            faults.append(f"control: time {frame} is time {frames[0]}")
    # Controls: files that are broken are found to be.
    whole = (folder / "strands.usdc").read_bytes()
    (folder / "control_cut.usdc").write_bytes(whole[: len(whole) // 2])
    text = (folder / "strands.usda").read_text()
    for name, old, new in [
        ("control_unit.usda", "metersPerUnit = 1", "metersPerUnit = 2"),
        # What the compliance checker alone looks at.
        ("control_type.usda", "float[] widths", "double[] widths"),
        ("control_count.usda", "int[] curveVertexCounts = [", "int[] curveVertexCounts = [2, "),
    ]:
        if old not in text:
            faults.append(f"control: {name}: there is no `{old}`")
        (folder / name).write_text(text.replace(old, new, 1))
    for name in ["control_cut.usdc", "control_unit.usda", "control_type.usda", "control_count.usda"]:
        if not check_stage(folder / name, frames, fps)[0]:
            faults.append(f"control: {name} was found good")
    points = sum(len(p) for p in [points_at(stages["strands.usdc"], frames[0])])
    print(f"{points} points at {len(frames)} times", file=sys.stderr)
    return faults


if __name__ == "__main__":
    print("\n".join(main(sys.argv[1])), end="")
