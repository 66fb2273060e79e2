// A square of four vertices under a cage of one large triangle, as in ../native/main.cpp, without Unity.
using System;

static class Program {
    static void Main() {
        var cage = new CagecastInput {
            Positions = new float[] { -1, -1, 0.1f, 3, -1, 0.1f, -1, 3, 0.1f },
            Uvs = new float[] { 0, 0, 1, 0, 0, 1 },
            Indices = new uint[] { 0, 1, 2 },
        };
        var square = new CagecastInput {
            Positions = new float[] { 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0 },
            Indices = new uint[] { 0, 1, 2, 0, 2, 3 },
        };
        var result = Cagecast.Transfer(cage, square);
        Console.WriteLine($"corner 0: u = {result.CornerUvs[0]}, v = {result.CornerUvs[1]}; triangles: {string.Join(" ", result.Painted)}");
        try {
            Cagecast.Transfer(cage, square, threshold: 2);
        } catch (ArgumentException error) {
            Console.WriteLine(error.Message);
        }
    }
}
