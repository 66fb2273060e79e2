"""Blender's modifier Data Transfer: UVs of the nearest face, as far as a distance. blender.sh starts it."""

import json
import sys
import time

import bpy
import numpy as np

REACH = 0.05  # of the cage's diagonal


def reply(what):
    print(json.dumps(what), flush=True)


def mesh_of(name, positions, triangles):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(positions.tolist(), [], triangles.tolist())
    return mesh


def show(name, mesh):
    made = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(made)
    return made


def zones(cage, target, diagonal):
    """The transfer itself, from meshes to the vertices that got a UV."""
    target.modifiers.clear()
    modifier = target.modifiers.new("transfer", "DATA_TRANSFER")
    modifier.object = cage
    modifier.use_loop_data = True
    modifier.data_types_loops = {"UV"}
    modifier.loop_mapping = "POLYINTERP_NEAREST"
    modifier.use_max_distance = True
    modifier.max_distance = REACH * diagonal
    done = target.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    uvs = np.empty(2 * len(done.loops), np.float32)
    done.uv_layers[0].data.foreach_get("uv", uvs)
    corners = np.empty(len(done.loops), np.int64)
    done.loops.foreach_get("vertex_index", corners)
    got = np.zeros(len(done.vertices), bool)
    got[corners[(uvs.reshape(-1, 2) >= 0).all(1)]] = True
    return ~got


def main():
    for old in list(bpy.data.objects):
        bpy.data.objects.remove(old)
    reply({"ready": True})
    task = json.loads(sys.stdin.readline())
    read = lambda name: np.load(f"{task['folder']}/{name}.npy")
    cage_positions, cage_indices = read("cage_positions"), read("cage_indices").reshape(-1, 3)
    cage_mesh = mesh_of("cage", cage_positions, cage_indices)
    layer = cage_mesh.uv_layers.new(name="UV")
    layer.data.foreach_set("uv", read("cage_uvs").reshape(-1, 2)[cage_indices.ravel()].ravel())
    target_mesh = mesh_of("target", read("target_positions"), read("target_indices").reshape(-1, 3))
    # A UV that no texture has stands for none.
    target_mesh.uv_layers.new(name="UV").data.foreach_set("uv", np.full(2 * len(target_mesh.loops), -1, np.float32))
    cage, target = show("cage", cage_mesh), show("target", target_mesh)
    diagonal = float(np.linalg.norm(np.ptp(cage_positions, axis=0)))
    seconds = []
    for run in range(task["runs"] + 1):
        began = time.perf_counter()
        found = zones(cage, target, diagonal)
        if run > 0:
            seconds.append(time.perf_counter() - began)
    np.save(f"{task['folder']}/zones.npy", found)
    reply({"seconds": seconds})
    sys.stdin.read()


try:
    main()
except Exception as error:  # Blender would go on
    reply({"error": str(error)})
    raise
