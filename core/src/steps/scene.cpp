#include "steps/scene.hpp"

#include "input/ignored_parts.hpp"
#include "input/validate.hpp"
#include "search/target_tree.hpp"

namespace cagecast {

Status Scene::load() noexcept {
  if (!options.parts.ignore.empty()) {
    if (const Status status = checkArrays(targetMesh, Argument::target); !status.ok()) return status;
    if (const Status status = ignoreParts(options.parts.ignore, arena, targetMesh); !status.ok()) return status;
  }
  if (const Status status = checkMeshes(cageMesh, targetMesh, units); !status.ok()) return status;
  if (!gatherCage(cageMesh, units, arena, cage)) return {Code::outOfMemory};
  if (cage.count == 0) return {Code::noUsableCageTriangle, Argument::cage};
  const float tolerance = options.weldTolerance;
  const Code code = weld(targetMesh, units, tolerance, arena, points);
  if (code == Code::weldToleranceTooLarge) return {code, Argument::options, 0, Option::weldTolerance, tolerance};
  return {code};
}

void Scene::buildTrees() noexcept {
  const Steps& steps = options.steps;
  const bool needsLoops = options.pokeThrough > 0 || steps.interiorSamples || steps.holes;
  const bool needsHalfEdges = needsLoops || options.seams == Seams::corner;
  const bool isDone = buildCageTree(cage, units, arena, cageTree) &&
                      buildTargetTree(points, units, arena, targetTree) &&
                      (!needsHalfEdges || findHalfEdges(cageMesh, cage, arena, halfEdges)) &&
                      (!needsLoops || findBoundaryLoops(cage, halfEdges, arena, loops));
  if (!isDone) arena.fail();
}

}  // namespace cagecast
