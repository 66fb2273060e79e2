"""python3 program.py LIBRARY: the C interface by ctypes, with the standard library alone. Nothing is wrong if it prints nothing."""

import ctypes
import sys
from ctypes import POINTER, byref, c_char, c_char_p, c_float, c_int32, c_uint8, c_uint32, c_void_p

library = ctypes.CDLL(sys.argv[1])


def struct(name, **fields):
    return type(name, (ctypes.Structure,), {"_fields_": list(fields.items())})


Error = struct("Error", code=c_char_p, argument=c_char_p, option=c_char_p, at=c_uint32, value=c_float, message=c_char * 512)
Mesh = struct("Mesh", positions=POINTER(c_float), indices=POINTER(c_uint32), uvs=POINTER(c_float), groups=c_void_p,
              poses=c_void_p, vertexCount=c_uint32, triangleCount=c_uint32, poseCount=c_uint32)
Transfer = struct("Transfer", uvs=POINTER(c_float), cornerUvs=POINTER(c_float), zones=POINTER(c_uint8),
                  cosmeticTriangles=POINTER(c_uint8), cageTriangles=POINTER(c_uint32), distances=POINTER(c_float),
                  segments=POINTER(c_uint32), segmentStats=c_void_p, vertexCount=c_uint32, triangleCount=c_uint32,
                  segmentCount=c_uint32, error=Error, memory=c_void_p)


def floats(*values):
    return (c_float * len(values))(*values)


def ints(*values):
    return (c_uint32 * len(values))(*values)


cage = Mesh(floats(-1, -1, 0.1, 3, -1, 0.1, -1, 3, 0.1), ints(0, 1, 2), floats(0, 0, 1, 0, 0, 1), None, None, 3, 1, 0)
square = Mesh(floats(0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0), ints(0, 1, 2, 0, 2, 3), None, None, None, 4, 2, 0)
out = Transfer()
assert library.cagecastTransfer(byref(cage), byref(square), None, byref(out)) == 0, out.error.message
assert out.uvs[:4] == [0.25, 0.25, 0.5, 0.25] and out.zones[:4] == [0, 0, 0, 0] and out.cosmeticTriangles[:2] == [1, 1]

square.indices[4] = 9
assert library.cagecastTransfer(byref(cage), byref(square), None, byref(out)) == 1 and not out.uvs
assert (out.error.code, out.error.argument, out.error.at) == (b"indexOutOfRange", b"target", 4)
assert b"target.indices[4] = 9" in out.error.message
library.cagecastFreeTransfer(byref(out))
assert out.memory is None
