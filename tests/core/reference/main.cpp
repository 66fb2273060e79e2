/// Runs the brute-force reference, or the library itself, over one scene file, so that hosts in other languages can
/// compare their answer with it on exactly the same arrays.
///
// clang-format off
///     cagecast_reference SCENE RESULT [--preset paper|default|earlier] [--without STEP] [--threshold T] [--unchecked] [--product]
///     cagecast_reference --golden FOLDER
///     cagecast_reference --traps FOLDER
// clang-format on
///
/// --without leaves a step of the preset `default` out (may be given more than once): groups, end-of-self-ray, pokes,
/// interior-samples, far-loops, floor, depth-weighting, twins, hole-contents, recheck, both-sides, exposed-side,
/// holes, triangles, seams. --preset earlier is `default` with step 4', the floor and the recheck as they were
/// first written down.
/// --unchecked does not ask which vertices are stable. --product asks the library instead, which knows nothing of
/// --without. The second form writes the scenes of the golden hashes, in their order, as FOLDER/0.scene and so on, and
/// those that are cut as FOLDER/borders-0.scene and so on; the third the models made to be difficult as
/// FOLDER/NAME.scene, each with the truth about its vertices in FOLDER/NAME.truth: u8 per target vertex, 0 to be
/// painted, 1 not to be, 2 either.
///
/// SCENE, little-endian: "CAGESCN1", then the cage, then the target, each as u32 vertexCount, u32 indexCount,
/// u8 hasUvs, u8 hasGroups, two bytes 0, f32 positions, u32 indices, f32 uvs (if any), u32 groups (if any).
/// RESULT: "CAGEREF1", u32 vertexCount, u32 segmentCount, f32 uvs (2 per vertex), u8 zones (then to a multiple of 4),
/// u32 triangles, f32 distances, u32 segments, u8 stable (then to a multiple of 4), and per segment u32 points,
/// u32 culled, f64 exposed area, f64 covered area; then u32 triangleCount, u32 cornerUvCount, u8 cosmeticTriangles (to
/// a multiple of 4), and if there are any f32 cornerUvs and u8 stableCorners (to a multiple of 4); then, by the
/// reference, per segment f64 whole area, f64 depth-weighted area. Exit code 1, and a line on stderr, if it cannot be
/// done.

#include <algorithm>
#include <bit>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "reference/reference.hpp"
#include "scenes/scenes.hpp"
#include "scenes/traps.hpp"

namespace {

using namespace cagecast;

static_assert(std::endian::native == std::endian::little, "the files are written as they lie in memory");

struct Mesh {
  std::vector<float> positions, uvs;
  std::vector<std::uint32_t> indices, groups;
  MeshView view() const { return {positions, indices, uvs, groups}; }
};

/// Takes values off the front of a file's bytes.
struct Reader {
  std::vector<char> bytes;
  std::size_t at = 0;
  bool good = true;

  template <typename T>
  void take(std::vector<T>& values, std::size_t count) {
    good = good && count <= (bytes.size() - at) / sizeof(T);
    if (!good) return;
    values.resize(count);
    if (count > 0) std::memcpy(values.data(), bytes.data() + at, count * sizeof(T));
    at += count * sizeof(T);
  }
};

bool takeMesh(Reader& in, Mesh& mesh) {
  std::vector<std::uint32_t> counts;
  std::vector<std::uint8_t> flags;
  in.take(counts, 2);
  in.take(flags, 4);
  if (!in.good) return false;
  in.take(mesh.positions, std::size_t{counts[0]} * 3);
  in.take(mesh.indices, counts[1]);
  if (flags[0] != 0) in.take(mesh.uvs, std::size_t{counts[0]} * 2);
  if (flags[1] != 0) in.take(mesh.groups, counts[0]);
  return in.good;
}

template <typename T>
void put(std::vector<char>& out, const T* values, std::size_t count) {
  if (count == 0) return;
  const std::size_t start = out.size();
  out.resize(start + count * sizeof(T));
  std::memcpy(out.data() + start, values, count * sizeof(T));
  out.resize((out.size() + 3) / 4 * 4);
}

void putMesh(std::vector<char>& out, const MeshView& mesh) {
  const std::uint32_t counts[] = {static_cast<std::uint32_t>(mesh.positions.size() / 3),
                                  static_cast<std::uint32_t>(mesh.indices.size())};
  const std::uint8_t flags[] = {!mesh.uvs.empty(), !mesh.groups.empty(), 0, 0};
  put(out, counts, 2);
  put(out, flags, 4);
  put(out, mesh.positions.data(), mesh.positions.size());
  put(out, mesh.indices.data(), mesh.indices.size());
  put(out, mesh.uvs.data(), mesh.uvs.size());
  put(out, mesh.groups.data(), mesh.groups.size());
}

bool save(const std::string& path, const std::vector<char>& bytes) {
  std::ofstream file(path, std::ios::binary);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  return static_cast<bool>(file.flush());
}

int fail(const std::string& message) {
  std::fprintf(stderr, "cagecast_reference: %s\n", message.c_str());
  return 1;
}

bool saveScene(const std::string& path, const MeshView& cage, const MeshView& target) {
  std::vector<char> out;
  put(out, "CAGESCN1", 8);
  putMesh(out, cage);
  putMesh(out, target);
  return save(path, out);
}

int writeGolden(const std::string& folder) {
  const std::pair<const char*, std::vector<scenes::Scene>> kinds[] = {{"", scenes::golden()},
                                                                      {"borders-", scenes::goldenBorders()}};
  for (const auto& [prefix, all] : kinds) {
    for (std::size_t i = 0; i < all.size(); ++i) {
      const std::string path = folder + "/" + prefix + std::to_string(i) + ".scene";
      if (!saveScene(path, all[i].cage.view(), all[i].target.view())) return fail(path + " cannot be written");
    }
  }
  return 0;
}

int writeTraps(const std::string& folder) {
  for (const scenes::Trap& trap : scenes::traps()) {
    const std::string path = folder + "/" + trap.scene.name;
    std::vector<char> truth;
    put(truth, trap.truth.data(), trap.truth.size());
    if (!saveScene(path + ".scene", trap.scene.cage.view(), trap.scene.target.view()) || !save(path + ".truth", truth))
      return fail(path + " cannot be written");
  }
  return 0;
}

/// The steps of the preset `default` by name, but for the floor, which is no yes or no.
constexpr std::pair<std::string_view, bool reference::Options::*> kSteps[] = {
    {"groups", &reference::Options::groups},
    {"end-of-self-ray", &reference::Options::endOfSelfRay},
    {"pokes", &reference::Options::pokes},
    {"interior-samples", &reference::Options::interiorSamples},
    {"far-loops", &reference::Options::farLoops},
    {"depth-weighting", &reference::Options::depthWeighting},
    {"twins", &reference::Options::twins},
    {"hole-contents", &reference::Options::holeContents},
    {"recheck", &reference::Options::recheck},
    {"both-sides", &reference::Options::bothSides},
    {"exposed-side", &reference::Options::exposedSide},
    {"holes", &reference::Options::holes},
    {"triangles", &reference::Options::partialTriangles},
    {"seams", &reference::Options::seams},
};

}  // namespace

int main(int argc, char** argv) {
  if (argc == 3 && std::string_view(argv[1]) == "--golden") return writeGolden(argv[2]);
  if (argc == 3 && std::string_view(argv[1]) == "--traps") return writeTraps(argv[2]);
  TransferOptions options = TransferOptions::paper();
  float threshold = options.threshold;
  reference::Options plain = reference::Options::paper();
  std::vector<std::string> without;
  bool useProduct = false, isChecked = true;
  std::vector<std::string> files;
  for (int i = 1; i < argc; ++i) {
    const std::string_view argument = argv[i];
    if (argument == "--product") {
      useProduct = true;
    } else if (argument == "--unchecked") {
      isChecked = false;
    } else if (argument == "--preset" && i + 1 < argc) {
      const std::string_view preset = argv[++i];
      if (preset == "paper") {
        options = TransferOptions::paper();
        plain = reference::Options::paper();
      } else if (preset == "default") {
        options = TransferOptions{};
        plain = reference::Options::standard();
      } else if (preset == "earlier") {
        options = TransferOptions{};
        options.steps.floor = Floor::area;
        options.steps.twins = options.steps.holeContents = options.steps.bothSides = options.steps.depthWeighting =
            options.steps.farLoops = options.steps.exposedSide = false;
        plain = reference::Options::earlier();
      } else {
        return fail("--preset " + std::string(preset) + ": there are paper, default and earlier");
      }
    } else if (argument == "--without" && i + 1 < argc) {
      without.emplace_back(argv[++i]);
    } else if (argument == "--threshold" && i + 1 < argc) {
      char* end = nullptr;
      threshold = static_cast<float>(std::strtod(argv[++i], &end));
      if (*end != '\0') return fail("--threshold " + std::string(argv[i]) + " is not a number");
    } else {
      files.emplace_back(argument);
    }
  }
  if (files.size() != 2)
    return fail(
        "usage: cagecast_reference SCENE RESULT [--preset paper|default|earlier] [--without STEP] [--threshold T] "
        "[--unchecked] [--product]");
  for (const std::string& step : without) {
    if (step == "floor") {
      plain.floor = Floor::none;
      continue;
    }
    const auto known =
        std::find_if(std::begin(kSteps), std::end(kSteps), [&](const auto& s) { return s.first == step; });
    if (known == std::end(kSteps)) return fail("--without " + step + ": there is no such step");
    plain.*(known->second) = false;
  }
  options.threshold = threshold;
  plain.threshold = static_cast<double>(threshold);
  plain.stability = isChecked;

  std::ifstream file(files[0], std::ios::binary);
  if (!file) return fail(files[0] + " cannot be read");
  Reader in{{std::istreambuf_iterator<char>(file), {}}};
  std::vector<char> magic;
  in.take(magic, 8);
  if (!in.good || std::memcmp(magic.data(), "CAGESCN1", 8) != 0) return fail(files[0] + " is not a scene file");
  Mesh cage, target;
  if (!takeMesh(in, cage) || !takeMesh(in, target)) return fail(files[0] + " is truncated");

  if (useProduct && !without.empty()) return fail("--product does not go with --without");
  // The reference takes valid meshes only, so the library is asked first either way.
  Workspace workspace;
  TransferResult product;
  const Status status = transfer(cage.view(), target.view(), options, workspace, product);
  if (!status.ok()) return fail(describe(status, cage.view(), target.view()));

  std::vector<char> out;
  const auto write = [&](const auto& answer, const auto& zones, const auto& stable, const auto& cosmeticTriangles,
                         const std::vector<float>& cornerUvs, const std::vector<std::uint8_t>& stableCorners) {
    const std::uint32_t vertexCount = static_cast<std::uint32_t>(zones.size());
    const std::uint32_t segmentCount = static_cast<std::uint32_t>(answer.segmentStats.size());
    put(out, "CAGEREF1", 8);
    put(out, &vertexCount, 1);
    put(out, &segmentCount, 1);
    put(out, answer.uvs.data(), answer.uvs.size());
    put(out, zones.data(), zones.size());
    put(out, answer.triangles.data(), answer.triangles.size());
    put(out, answer.distances.data(), answer.distances.size());
    put(out, answer.segments.data(), answer.segments.size());
    put(out, stable.data(), stable.size());
    for (const SegmentStats& stats : answer.segmentStats) {
      const std::uint32_t counts[] = {stats.points, stats.culled() ? 1u : 0u};
      const double areas[] = {stats.exposedArea, stats.coveredArea};
      put(out, counts, 2);
      put(out, areas, 2);
    }
    const std::uint32_t counts[] = {static_cast<std::uint32_t>(cosmeticTriangles.size()),
                                    static_cast<std::uint32_t>(cornerUvs.size())};
    put(out, counts, 2);
    put(out, cosmeticTriangles.data(), cosmeticTriangles.size());
    put(out, cornerUvs.data(), cornerUvs.size());
    put(out, stableCorners.data(), stableCorners.size());
  };
  if (useProduct) {
    write(product.projection, product.zones.zones, std::vector<std::uint8_t>(product.zones.zones.size(), 1),
          product.zones.cosmeticTriangles, {product.projection.cornerUvs.begin(), product.projection.cornerUvs.end()},
          {});
  } else {
    const reference::Result result = reference::transfer(cage.view(), target.view(), plain);
    write(result, result.zones, result.stable, result.cosmeticTriangles, result.cornerUvs, result.stableCorners);
    for (const SegmentStats& segment : result.segmentStats) {
      const double areas[] = {segment.area, segment.depthWeightedArea};
      put(out, areas, 2);
    }
  }
  if (!save(files[1], out)) return fail(files[1] + " cannot be written");
}
