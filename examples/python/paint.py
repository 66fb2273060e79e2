"""python3 paint.py TARGET.glb CAGE.glb RESULT.npz: what of a model may be painted, and where it lies in the texture."""

import json
import sys

import numpy as np

from cagecast import transfer

kTypes = {5121: np.uint8, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}
kSizes = {"SCALAR": 1, "VEC2": 2, "VEC3": 3}


def read(path):
    """All triangles of a GLB whose nodes do not move their meshes and which is not compressed, as the samples are."""
    data = open(path, "rb").read()
    length = int.from_bytes(data[12:16], "little")
    gltf = json.loads(data[20 : 20 + length])
    binary = data[28 + length :]

    def values(number):
        accessor = gltf["accessors"][number]
        view = gltf["bufferViews"][accessor["bufferView"]]
        kind, size = np.dtype(kTypes[accessor["componentType"]]), kSizes[accessor["type"]]
        stride = view.get("byteStride", kind.itemsize * size)
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        return np.ndarray((accessor["count"], size), kind, binary, start, (stride, kind.itemsize))

    primitives = [one for node in gltf["nodes"] if "mesh" in node for one in gltf["meshes"][node["mesh"]]["primitives"]]
    positions = [values(one["attributes"]["POSITION"]) for one in primitives]
    starts = np.cumsum([0] + [len(part) for part in positions])
    mesh = {
        "positions": np.concatenate(positions),
        "indices": np.concatenate([values(p["indices"]).reshape(-1, 3) + s for p, s in zip(primitives, starts)]),
        "groups": np.repeat(np.arange(len(primitives)), [len(part) for part in positions]),
    }
    if all("TEXCOORD_0" in one["attributes"] for one in primitives):
        mesh["uvs"] = np.concatenate([values(one["attributes"]["TEXCOORD_0"]) for one in primitives])
    return mesh


target, cage, result = sys.argv[1:]
try:
    out = transfer(read(cage), read(target))
except ValueError as error:
    sys.exit(str(error))
np.savez(result, uvs=out.cornerUvs, painted=out.painted, zones=out.zones)
print(f"{out.painted.sum()} of {len(out.painted)} triangles may be painted")
