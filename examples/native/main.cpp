// Transfers UVs to a square of four vertices under a cage of one large triangle.
#include <cagecast/transfer.hpp>

#include <cstdint>
#include <cstdio>

int main() {
  const float cagePositions[] = {-1, -1, 0.1f, 3, -1, 0.1f, -1, 3, 0.1f}, cageUvs[] = {0, 0, 1, 0, 0, 1};
  const float squarePositions[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  const std::uint32_t cageIndices[] = {0, 1, 2}, squareIndices[] = {0, 1, 2, 0, 2, 3};
  const cagecast::MeshView cage{.positions = cagePositions, .indices = cageIndices, .uvs = cageUvs};
  const cagecast::MeshView square{.positions = squarePositions, .indices = squareIndices};

  cagecast::Workspace workspace;
  cagecast::TransferResult result;
  if (const auto status = cagecast::transfer(cage, square, {}, workspace, result); !status.ok()) {
    return std::fprintf(stderr, "%s\n", cagecast::describe(status, cage, square).c_str()), 1;
  }
  for (std::size_t v = 0; v < 4; ++v) {
    std::printf("vertex %zu: u = %g, v = %g, %s\n", v, result.projection.uvs[2 * v], result.projection.uvs[2 * v + 1],
                result.zones.zones[v] == cagecast::Zone::cosmetic ? "may be painted" : "must stay bare");
  }
}
