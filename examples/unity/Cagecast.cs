// Cagecast for Unity and .NET, by its C interface (core/include/cagecast/cagecast_c.h).
using System;
using System.Runtime.InteropServices;
using System.Text;

/// <summary>What of a model may be painted, and where it lies in the texture of its cage.</summary>
public sealed class CagecastResult {
    /// <summary>2 per index: the UV of each corner.</summary>
    public float[] CornerUvs;
    /// <summary>1 per triangle: 1 if it may be painted.</summary>
    public byte[] Painted;
    /// <summary>1 per vertex: 0 cosmetic, 1 occluded, 2 uncovered, 3 culled.</summary>
    public byte[] Zones;
}

/// <summary>Arrays of a mesh: 3 positions and 2 UVs per vertex, 3 indices per triangle. Groups number the parts.</summary>
public sealed class CagecastInput {
    public float[] Positions, Uvs;
    public uint[] Indices, Groups;

    /// <summary>Unity's triangles are clockwise, in left-handed space: mirrored in x, both are as Cagecast has them.</summary>
    public CagecastInput Mirrored() {
        var positions = (float[])Positions.Clone();
        for (int i = 0; i < positions.Length; i += 3) positions[i] = -positions[i];
        return new CagecastInput { Positions = positions, Uvs = Uvs, Indices = Indices, Groups = Groups };
    }
}

public static class Cagecast {
    /// <summary>Carries a cage's UVs to a target. Throws an ArgumentException whose message names what is wrong.</summary>
    public static CagecastResult Transfer(CagecastInput cage, CagecastInput target, float threshold = 0.5f) {
        var options = new Options();
        cagecastDefaults(ref options, 0);
        options.threshold = threshold;
        var result = new Result();
        using (var a = new Pinned(cage))
        using (var b = new Pinned(target)) {
            try {
                if (cagecastTransfer(ref a.Mesh, ref b.Mesh, ref options, ref result) != 0)
                    throw new ArgumentException(Encoding.UTF8.GetString(result.error.message).TrimEnd('\0'));
                return new CagecastResult {
                    CornerUvs = Copy(result.cornerUvs, new float[6 * result.triangleCount], Marshal.Copy),
                    Painted = Copy(result.cosmeticTriangles, new byte[result.triangleCount], Marshal.Copy),
                    Zones = Copy(result.zones, new byte[result.vertexCount], Marshal.Copy),
                };
            } finally {
                cagecastFreeTransfer(ref result);
            }
        }
    }

    static T[] Copy<T>(IntPtr from, T[] to, Action<IntPtr, T[], int, int> copy) {
        copy(from, to, 0, to.Length);
        return to;
    }

    /// <summary>A mesh whose arrays stay in their place during a call.</summary>
    sealed class Pinned : IDisposable {
        readonly GCHandle[] handles;
        public Mesh Mesh;

        public Pinned(CagecastInput input) {
            var arrays = new Array[] { input.Positions, input.Indices, input.Uvs, input.Groups };
            handles = Array.ConvertAll(arrays, array => GCHandle.Alloc(array, GCHandleType.Pinned));
            var at = Array.ConvertAll(handles, one => one.Target == null ? IntPtr.Zero : one.AddrOfPinnedObject());
            Mesh = new Mesh {
                positions = at[0], indices = at[1], uvs = at[2], groups = at[3],
                vertexCount = (uint)(input.Positions.Length / 3), triangleCount = (uint)(input.Indices.Length / 3),
            };
        }

        public void Dispose() => Array.ForEach(handles, one => one.Free());
    }

    [StructLayout(LayoutKind.Sequential)]
    struct Mesh {
        public IntPtr positions, indices, uvs, groups, poses;
        public uint vertexCount, triangleCount, poseCount;
    }

    [StructLayout(LayoutKind.Sequential)]
    struct List {
        public IntPtr items;
        public uint count;
    }

    [StructLayout(LayoutKind.Sequential)]
    struct Options {
        public int paper, seams, motion;
        public float threshold, minCovered, weldTolerance, occlusionReach, pokeThrough;
        public List ignore, keep, exclude;
        public IntPtr locks;
        public uint lockCount;
        public IntPtr vertexMasks, triangleMasks;
    }

    [StructLayout(LayoutKind.Sequential)]
    struct Error {
        public IntPtr code, argument, option;
        public uint at;
        public float value;
        [MarshalAs(UnmanagedType.ByValArray, SizeConst = 512)]
        public byte[] message;
    }

    [StructLayout(LayoutKind.Sequential)]
    struct Result {
        public IntPtr uvs, cornerUvs, zones, cosmeticTriangles, cageTriangles, distances, segments, segmentStats;
        public uint vertexCount, triangleCount, segmentCount;
        public Error error;
        public IntPtr memory;
    }

    const string Library = "cagecast";
    [DllImport(Library)] static extern void cagecastDefaults(ref Options options, int paper);
    [DllImport(Library)] static extern int cagecastTransfer(ref Mesh cage, ref Mesh target, ref Options options, ref Result result);
    [DllImport(Library)] static extern void cagecastFreeTransfer(ref Result result);
}
