"""Cagecast for Python with NumPy, by its C interface (core/include/cagecast/cagecast_c.h)."""

import ctypes
from ctypes import POINTER, Structure, byref, c_char, c_char_p, c_double, c_float, c_int8, c_int32, c_uint8, c_uint32, c_void_p
from pathlib import Path
from types import SimpleNamespace

import numpy as np

library = ctypes.CDLL(str(Path("libcagecast.so").resolve()))


class Error(Structure):
    _fields_ = [("code", c_char_p), ("argument", c_char_p), ("option", c_char_p), ("at", c_uint32), ("value", c_float),
                ("message", c_char * 512)]


class Mesh(Structure):
    _fields_ = [("positions", POINTER(c_float)), ("indices", POINTER(c_uint32)), ("uvs", POINTER(c_float)),
                ("groups", POINTER(c_uint32)), ("poses", POINTER(c_float)),
                ("vertexCount", c_uint32), ("triangleCount", c_uint32), ("poseCount", c_uint32)]


class List(Structure):
    _fields_ = [("items", POINTER(c_uint32)), ("count", c_uint32)]


class Options(Structure):
    _fields_ = [("paper", c_int32), ("seams", c_int32), ("motion", c_int32),
                ("threshold", c_float), ("minCovered", c_float),
                ("weldTolerance", c_float), ("occlusionReach", c_float), ("pokeThrough", c_float),
                ("ignore", List), ("keep", List), ("exclude", List),
                ("locks", c_void_p), ("lockCount", c_uint32),
                ("vertexMasks", POINTER(c_int8)), ("triangleMasks", POINTER(c_int8))]


class Segment(Structure):
    _fields_ = [("area", c_double), ("exposedArea", c_double), ("coveredArea", c_double),
                ("score", c_double), ("confidence", c_double),
                ("points", c_uint32), ("group", c_uint32), ("culledBy", c_uint8)]


class Transfer(Structure):
    _fields_ = [("uvs", POINTER(c_float)), ("cornerUvs", POINTER(c_float)), ("zones", POINTER(c_uint8)),
                ("cosmeticTriangles", POINTER(c_uint8)), ("cageTriangles", POINTER(c_uint32)),
                ("distances", POINTER(c_float)), ("segments", POINTER(c_uint32)), ("segmentStats", POINTER(Segment)),
                ("vertexCount", c_uint32), ("triangleCount", c_uint32), ("segmentCount", c_uint32),
                ("error", Error), ("memory", c_void_p)]


library.cagecastDefaults.argtypes = [POINTER(Options), c_int32]
library.cagecastDefaults.restype = None
library.cagecastTransfer.argtypes = [POINTER(Mesh), POINTER(Mesh), POINTER(Options), POINTER(Transfer)]
library.cagecastTransfer.restype = c_int32
library.cagecastFreeTransfer.argtypes = [POINTER(Transfer)]
library.cagecastFreeTransfer.restype = None


def _pointer(array, kind, shape=None):
    """A pointer to an array of a type, and the array, which has to stay while the pointer is used."""
    if array is None:
        return None, None
    array = np.ascontiguousarray(array, kind)
    if shape is not None and array.shape != shape:
        raise ValueError(f"an array has the shape {array.shape}, not {shape}")
    return np.ctypeslib.as_ctypes(array.reshape(-1)), array


def _mesh(positions, indices, uvs=None, groups=None):
    vertices, triangles = len(positions), len(indices)
    mesh = Mesh(vertexCount=vertices, triangleCount=triangles)
    mesh.positions, a = _pointer(positions, np.float32, (vertices, 3))
    mesh.indices, b = _pointer(indices, np.uint32, (triangles, 3))
    mesh.uvs, c = _pointer(uvs, np.float32, (vertices, 2))
    mesh.groups, d = _pointer(groups, np.uint32, (vertices,))
    mesh.arrays = a, b, c, d
    return mesh


def transfer(cage, target, **options):
    """Carries a cage's UVs to a target.

    cage, target: dictionaries of `positions` (n, 3), `indices` (m, 3), `uvs` (n, 2) of a cage, and `groups` (n,).
    options: numbers as in docs/options.md, such as threshold=0.6; vertexMasks (n,).
    Returns arrays: uvs (n, 2), cornerUvs (m, 3, 2), zones (n,), painted (m,), distances (n,), segments (n,).
    Raises ValueError with a sentence that names what is wrong.
    """
    given = Options()
    library.cagecastDefaults(byref(given), 0)
    masks = options.pop("vertexMasks", None)
    given.vertexMasks, masks = _pointer(masks, np.int8, (len(target["positions"]),))
    for name, value in options.items():
        if not hasattr(given, name):
            raise TypeError(f"there is no option {name}")
        setattr(given, name, value)
    out = Transfer()
    try:
        if library.cagecastTransfer(byref(_mesh(**cage)), byref(_mesh(**target)), byref(given), byref(out)) != 0:
            raise ValueError(out.error.message.decode())
        n, m = out.vertexCount, out.triangleCount
        copy = lambda pointer, *shape: np.ctypeslib.as_array(pointer, shape).copy()
        return SimpleNamespace(
            uvs=copy(out.uvs, n, 2),
            cornerUvs=copy(out.cornerUvs, m, 3, 2) if out.cornerUvs else None,
            zones=copy(out.zones, n),
            painted=copy(out.cosmeticTriangles, m).astype(bool),
            distances=copy(out.distances, n),
            segments=copy(out.segments, n),
        )
    finally:
        library.cagecastFreeTransfer(byref(out))
