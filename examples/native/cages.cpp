// Makes a cage for a cube, and carries the cage's UVs to it.
#include <cagecast/cages.hpp>
#include <cagecast/transfer.hpp>

#include <algorithm>
#include <cstdint>
#include <cstdio>

int main() {
  const float positions[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 0, 1, 1, 0, 1, 0, 1, 1, 1, 1, 1};
  const std::uint32_t indices[] = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                   2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
  const cagecast::cages::Model model{.mesh = {.positions = positions, .indices = indices}};

  cagecast::cages::Cage cage;
  if (const auto status = cagecast::cages::makeCage(model, {}, nullptr, cage); !status.ok()) {
    return std::fprintf(stderr, "%s\n", cagecast::cages::describe(status, model).c_str()), 1;
  }
  cagecast::Workspace workspace;
  cagecast::TransferResult result;
  if (const auto status = cagecast::transfer(cage.view(), model.mesh, {}, workspace, result); !status.ok()) {
    return std::fprintf(stderr, "%s\n", cagecast::describe(status, cage.view(), model.mesh).c_str()), 1;
  }
  const auto& zones = result.zones.zones;
  std::printf("a cage of %zu triangles; %td of 8 vertices may be painted\n", cage.indices.size() / 3,
              std::count(zones.begin(), zones.end(), cagecast::Zone::cosmetic));
}
