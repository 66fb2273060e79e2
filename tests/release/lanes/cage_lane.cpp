/// Prints hashes of cages that are made, fitted and refined, and of landmarks. All builds for one machine print the
/// same; another one may have other sines and powers.

#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include "cagecast/cages.hpp"
#include "hash.hpp"

using namespace cagecast;
using namespace cagecast::cages;

namespace {

const std::vector<std::string> kParts{"head", "eye_left", "eye_right", "teeth_upper", "teeth_lower", "tongue"};

/// Ends the program where there is no answer.
void require(const Status& status, const char* what) {
  if (status.ok()) return;
  std::printf("%s: status %d\n", what, static_cast<int>(status.code));
  std::exit(1);
}

/// A head whose groups are its parts.
scenes::Mesh headOfParts() {
  scenes::Mesh mesh = scenes::head(20).target;
  std::map<std::uint32_t, std::uint32_t> places;
  for (std::uint32_t& group : mesh.groups)
    group = places.try_emplace(group, static_cast<std::uint32_t>(places.size())).first->second;
  return mesh;
}

template <typename T>
void add(Hash& hash, const std::vector<T>& values) {
  hash.addBytes(values.data(), values.size() * sizeof(T));
}

void add(Hash& hash, const std::vector<Landmark>& landmarks) {
  for (const Landmark& landmark : landmarks) {
    add(hash, std::vector<char>(landmark.name.begin(), landmark.name.end()));
    add(hash, std::vector<float>(landmark.position.begin(), landmark.position.end()));
    add(hash, std::vector<float>{landmark.confidence});
  }
}

void add(Hash& hash, const Cage& cage) {
  add(hash, cage.positions);
  add(hash, cage.uvs);
  add(hash, cage.indices);
  add(hash, cage.landmarks);
}

Cage made(const Model& model, Kind kind) {
  MakeOptions options;
  options.kind = kind;
  options.voxels = 60;
  options.triangles = 300;
  Cage cage;
  require(makeCage(model, options, {}, cage), "make");
  return cage;
}

/// Spots on the face of `scenes::head`, at its middle and on both sides.
std::vector<Landmark> spotsOf(const scenes::Mesh& mesh) {
  std::vector<Landmark> spots;
  const char* const names[] = {"nose_tip", "chin", "crown", "ear_top_left", "ear_top_right", "head_back"};
  const scenes::Point ways[] = {{0, 0, 1}, {0, -0.8f, 0.6f}, {0, 1, 0}, {1, 0.2f, 0}, {-1, 0.2f, 0}, {0, 0.2f, -1}};
  for (std::size_t i = 0; i < std::size(ways); ++i) {
    float most = -1e30f;
    std::size_t best = 0;
    for (std::size_t v = 0; v < mesh.vertexCount(); ++v) {
      const scenes::Point p = mesh.vertex(v);
      const float along = p[0] * ways[i][0] + p[1] * ways[i][1] + p[2] * ways[i][2];
      if (along > most) most = along, best = v;
    }
    spots.push_back({names[i], mesh.vertex(best)});
  }
  return spots;
}

}  // namespace

int main() {
  Hash ofMade, ofFitted, ofRefined, ofLandmarks;
  const scenes::Mesh head = headOfParts(), stairs = scenes::stairs().target;
  const auto wide = [](scenes::Point p) { return scenes::Point{1.1f * p[0], p[1], 0.9f * p[2] + 0.1f * p[1]}; };
  const auto aside = [](scenes::Point p) { return scenes::Point{p[0] + 0.02f, 1.01f * p[1], p[2]}; };
  const scenes::Mesh other = scenes::mapped(head, wide), turned = scenes::rotated(other, {20, 1, 2, 3});
  const scenes::Mesh moved = scenes::mapped(head, aside);
  const auto modelOf = [](const scenes::Mesh& mesh) {
    return Model{{mesh.positions, mesh.indices, {}, mesh.groups}, kParts};
  };

  const Cage cage = made(modelOf(head), Kind::head);
  for (const Cage& each : {cage, made(modelOf(head), Kind::body), made({stairs.view()}, Kind::prop)}) add(ofMade, each);

  const Template from{cage.view(), spotsOf(head), Kind::head};
  FitOptions options;
  options.landmarks = spotsOf(other);
  FittedCage fitted;
  require(fitCage(from, modelOf(other), options, {}, fitted), "fit");
  add(ofFitted, fitted);

  Cage refined;
  require(refineCage(cage.view(), modelOf(moved), {}, {}, refined), "refine");
  add(ofRefined, refined);
  if (refined.positions == cage.positions) require({Code::cageOff}, "nothing to refine");

  for (const scenes::Mesh& each : {head, turned}) {
    FoundLandmarks found;
    require(findLandmarks(modelOf(each), {}, found), "landmarks");
    if (found.landmarks.empty()) require({Code::cageOff}, "no landmarks");
    add(ofLandmarks, found.landmarks);
  }
  std::printf("%s %s %s %s\n", ofMade.text().c_str(), ofFitted.text().c_str(), ofRefined.text().c_str(),
              ofLandmarks.text().c_str());
}
