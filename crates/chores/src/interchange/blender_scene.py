"""Opens what Lovelock wrote in Blender, and writes files with Blender that Lovelock shall open.

Arguments: a folder with request.json: `files` to open, the `curves` and `points` that each holds, `frames` and `fps`, and the `bounds`
of the hair in metres with Y up. Prints a JSON object: `faults`, a line each, and `written`, the files with what they hold.
"""

import json
import math
import sys
from pathlib import Path

import bpy
from mathutils import Vector

# The most that a bound may be off, metres: radii belong to the bounds of some objects.
LIMIT = 5e-3
# A standing dancer, metres.
TALL = (1.5, 1.85)


def empty(fps):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.context.scene.render.fps = int(fps)


def open_file(path):
    kind = path.suffix
    if kind == ".abc":
        bpy.ops.wm.alembic_import(filepath=str(path), as_background_job=False, set_frame_range=True)
    elif kind in (".usdc", ".usda"):
        bpy.ops.wm.usd_import(filepath=str(path), set_frame_range=True)
    elif kind == ".glb":
        bpy.ops.import_scene.gltf(filepath=str(path))
    elif kind == ".obj":
        bpy.ops.wm.obj_import(filepath=str(path))
    elif kind == ".fbx":
        bpy.ops.import_scene.fbx(filepath=str(path))


def content(frame):
    """Curves, their points in world space, and vertices of surfaces at a frame."""
    bpy.context.scene.frame_set(frame)
    graph = bpy.context.evaluated_depsgraph_get()
    curves, points, body = 0, [], []
    for thing in bpy.context.scene.objects:
        # The glTF importer adds one as the shape of bones.
        if thing.name.startswith("Icosphere"):
            continue
        shown = thing.evaluated_get(graph)
        world = shown.matrix_world
        if thing.type == "CURVES":
            curves += len(shown.data.curves)
            points += [world @ point.position for point in shown.data.points]
        elif thing.type == "CURVE":
            curves += len(shown.data.splines)
            for spline in shown.data.splines:
                given = spline.bezier_points if spline.type == "BEZIER" else spline.points
                points += [world @ Vector(point.co[:3]) for point in given]
        elif thing.type == "MESH":
            mesh = shown.data
            vertices = [world @ vertex.co for vertex in mesh.vertices]
            if len(mesh.polygons) > 0:
                body += vertices
            else:
                # Every strand of a lines primitive has one edge less than it has vertices.
                curves += len(vertices) - len(mesh.edges)
                points += vertices
    return curves, points, body


def bounds(points):
    return [[f(point[axis] for point in points) for axis in range(3)] for f in (min, max)]


def check(path, request):
    empty(request["fps"])
    open_file(path)
    faults = []

    def expect(what, found, wanted):
        if found != wanted:
            faults.append(f"{path.name}: {what}: {found}, wanted {wanted}")

    first, last = request["frames"][0], request["frames"][1] - 1
    moves = path.suffix in (".abc", ".usdc", ".usda")
    curves, points, body = content(first if moves else 0)
    expect("curves", curves, request["curves"])
    expect("points", len(points), request["points"])
    if not points:
        return faults
    if moves:
        scene = bpy.context.scene
        expect("first frame", scene.frame_start, first)
        expect("last frame", scene.frame_end, last)
        _, later, body_later = content(last)
        expect("whether hair moves", max((a - b).length for a, b in zip(points, later)) > 1e-3, True)
        if body:
            moved = max((a - b).length for a, b in zip(body, body_later))
            expect("whether the body moves", moved > 1e-3, True)
    # Blender has Z up: our (x, y, z) is its (x, -z, y).
    low, high = request["bounds"]
    wanted = [[low[0], -high[2], low[1]], [high[0], -low[2], high[1]]]
    off = max(abs(a - b) for found, want in zip(bounds(points), wanted) for a, b in zip(found, want))
    if path.suffix != ".glb" and off > LIMIT:
        faults.append(f"{path.name}: the hair reaches {bounds(points)}, wanted {wanted}")
    if path.suffix in (".abc", ".usdc", ".usda", ".glb") and request["body"]:
        if not body:
            faults.append(f"{path.name}: no body")
        else:
            low, high = bounds(body)
            if not (abs(low[2]) < 0.3 and TALL[0] < high[2] - low[2] + 0.3 < TALL[1] + 0.6):
                faults.append(f"{path.name}: the body reaches from {low} to {high}")
    return faults


def hair_curves():
    """Twenty hair curves of five points, which hang down by 0.1 m per point; the root of each is on a line of 0.19 m."""
    data = bpy.data.hair_curves.new("Hair")
    data.add_curves([5] * 20)
    for curve in range(20):
        for point in range(5):
            data.points[curve * 5 + point].position = (0.01 * curve, 0.0, 1.6 - 0.1 * point)
            data.points[curve * 5 + point].radius = 0.0005
    thing = bpy.data.objects.new("Hair", data)
    bpy.context.scene.collection.objects.link(thing)
    return thing


def particle_hair():
    bpy.ops.mesh.primitive_uv_sphere_add(radius=0.1, location=(0, 0, 1.6))
    head = bpy.context.object
    head.modifiers.new("Hair", "PARTICLE_SYSTEM")
    settings = head.particle_systems[0].settings
    settings.type = "HAIR"
    settings.count = 30
    settings.hair_length = 0.2
    settings.hair_step = 4


# Joints of a figure: name, parent, head and tail.
BONES = [
    ("hips", None, (0, 0, 1.0), (0, 0, 1.15)),
    ("spine", "hips", (0, 0, 1.15), (0, 0, 1.3)),
    ("chest", "spine", (0, 0, 1.3), (0, 0, 1.5)),
    ("neck", "chest", (0, 0, 1.5), (0, 0, 1.6)),
    ("head", "neck", (0, 0, 1.6), (0, 0, 1.8)),
] + [
    bone
    for side, x in (("L", 1), ("R", -1))
    for bone in [
        (f"shoulder.{side}", "chest", (0.03 * x, 0, 1.45), (0.15 * x, 0, 1.48)),
        (f"upper_arm.{side}", f"shoulder.{side}", (0.15 * x, 0, 1.48), (0.42 * x, 0, 1.48)),
        (f"forearm.{side}", f"upper_arm.{side}", (0.42 * x, 0, 1.48), (0.67 * x, 0, 1.48)),
        (f"hand.{side}", f"forearm.{side}", (0.67 * x, 0, 1.48), (0.8 * x, 0, 1.48)),
        (f"thigh.{side}", "hips", (0.1 * x, 0, 1.0), (0.1 * x, 0, 0.52)),
        (f"shin.{side}", f"thigh.{side}", (0.1 * x, 0, 0.52), (0.1 * x, 0, 0.08)),
        (f"foot.{side}", f"shin.{side}", (0.1 * x, 0, 0.08), (0.1 * x, -0.15, 0.02)),
    ]
]


def figure(fps):
    """A skinned figure of boxes, one per bone, that nods and lifts an arm in a second."""
    armature = bpy.data.armatures.new("Rig")
    rig = bpy.data.objects.new("Rig", armature)
    bpy.context.scene.collection.objects.link(rig)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    for name, parent, head, tail in BONES:
        bone = armature.edit_bones.new(name)
        bone.head, bone.tail = head, tail
        bone.parent = armature.edit_bones[parent] if parent else None
    bpy.ops.object.mode_set(mode="OBJECT")
    vertices, faces, owners = [], [], []
    for name, _, head, tail in BONES:
        start = len(vertices)
        middle, along = (Vector(head) + Vector(tail)) / 2, Vector(tail) - Vector(head)
        half = [max(abs(along[axis]) / 2, 0.04) for axis in range(3)]
        for corner in range(8):
            signs = [1 if corner >> axis & 1 else -1 for axis in range(3)]
            vertices.append(middle + Vector(s * h for s, h in zip(signs, half)))
            owners.append(name)
        sides = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
        faces += [tuple(start + i for i in side) for side in sides]
    mesh = bpy.data.meshes.new("Body")
    mesh.from_pydata(vertices, [], faces)
    body = bpy.data.objects.new("Body", mesh)
    bpy.context.scene.collection.objects.link(body)
    for name, *_ in BONES:
        group = body.vertex_groups.new(name=name)
        group.add([i for i, owner in enumerate(owners) if owner == name], 1.0, "REPLACE")
    body.modifiers.new("Rig", "ARMATURE").object = rig
    body.parent = rig
    fps = int(fps)
    bpy.context.scene.frame_start, bpy.context.scene.frame_end = 0, fps
    for frame, turn in ((0, 0.0), (fps // 2, 0.6), (fps, 0.0)):
        for name in ("head", "upper_arm.L"):
            bone = rig.pose.bones[name]
            bone.rotation_mode = "XYZ"
            bone.rotation_euler = (turn, 0, 0)
            bone.keyframe_insert("rotation_euler", frame=frame)
    return vertices


def write(folder, fps):
    """What Blender writes: each file with its kind and what it holds."""
    written = []

    def hair(make, name, curves, points, height):
        empty(fps)
        make()
        bpy.context.scene.frame_set(1)
        for ending in (".abc", ".usdc"):
            path = folder / (name + ending)
            if ending == ".abc":
                bpy.ops.wm.alembic_export(filepath=str(path), as_background_job=False, start=1, end=1, export_hair=True)
            else:
                bpy.ops.wm.usd_export(filepath=str(path), export_hair=True)
            # USD holds the smooth curves, whose polylines have more points.
            counted = points if ending == ".abc" else None
            written.append({"file": path.name, "kind": "hair", "strands": curves, "points": counted, "height": height})

    hair(hair_curves, "hair_curves", 20, 100, 0.4)
    hair(particle_hair, "particle_hair", 30, None, None)
    empty(fps)
    vertices = figure(fps)
    height = max(v.z for v in vertices) - min(v.z for v in vertices)
    for ending in (".fbx", ".glb", ".usdc"):
        path = folder / ("figure" + ending)
        if ending == ".fbx":
            bpy.ops.export_scene.fbx(filepath=str(path), add_leaf_bones=False, bake_anim_simplify_factor=0.0)
        elif ending == ".glb":
            bpy.ops.export_scene.gltf(filepath=str(path))
        else:
            bpy.ops.wm.usd_export(filepath=str(path), export_animation=True, export_armatures=True)
        written.append({"file": path.name, "kind": "character", "joints": len(BONES), "height": height, "secs": 1.0})
    return written


def main():
    folder = Path(sys.argv[1])
    request = json.loads((folder / "request.json").read_text())
    faults = []
    for name in request["files"]:
        try:
            faults += check(folder / name, request)
        except RuntimeError as error:
            faults.append(f"{name}: {error}".strip())
    told = {"faults": faults, "written": write(folder, request["fps"]), "version": bpy.app.version_string}
    (folder / "told.json").write_text(json.dumps(told))


main()
