/// Measures the library, and peers beside it, in CPU time.
///
///     cagecast_bench TARGET.glb CAGE.glb [--preset paper|default] [--seams vertex|corner] [--runs 101] [--peers
///     embree,nanoflann] [--json] cagecast_bench FILE.scene [...] cagecast_bench TARGET.glb CAGE.glb --save FILE.scene
///
/// Every run is the whole work from raw arrays to zones. With peers, the runs alternate (library, peer, library, peer,
/// …) and a ratio is the median of the ratios of such pairs, so that what else the machine does falls on both alike.
/// The library is its own peer with another preset, `paper` or `default`. Exit code 1 if the input is unusable, 2 for
/// wrong usage; a line on stderr says why.

#include <sched.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hash.hpp"
#include "model.hpp"
#include "peer.hpp"

namespace {

using namespace cagecast;
using bench::Peer;

struct Arguments {
  std::vector<std::string> files;
  std::vector<std::string> peers;
  TransferOptions options = TransferOptions::paper();
  std::string save;  ///< Write the input to this scene file, and measure nothing.
  int runs = 101;
  bool json = false;
};

[[noreturn]] void stop(int exitCode, const std::string& message) {
  std::fprintf(stderr, "cagecast_bench: %s\n", message.c_str());
  std::exit(exitCode);
}

Arguments parse(int argc, char** argv) {
  Arguments arguments;
  std::optional<Seams> seams;  // Those of the preset.
  for (int i = 1; i < argc; ++i) {
    const std::string_view argument = argv[i];
    const auto value = [&] {
      if (++i == argc) stop(2, std::string(argument) + " needs a value");
      return std::string_view(argv[i]);
    };
    if (argument == "--json") {
      arguments.json = true;
    } else if (argument == "--runs") {
      const std::string_view text = value();
      const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), arguments.runs);
      if (error != std::errc{} || end != text.data() + text.size() || arguments.runs < 1)
        stop(2, "--runs " + std::string(text) + " is not a whole number of at least 1");
    } else if (argument == "--preset") {
      const std::string_view preset = value();
      if (preset != "paper" && preset != "default")
        stop(2, "no preset \"" + std::string(preset) + "\"; there are: paper, default");
      arguments.options = preset == "paper" ? TransferOptions::paper() : TransferOptions{};
    } else if (argument == "--seams") {
      const std::string_view text = value();
      if (text != "vertex" && text != "corner")
        stop(2, "no seams \"" + std::string(text) + "\"; there are: vertex, corner");
      seams = text == "vertex" ? Seams::vertex : Seams::corner;
    } else if (argument == "--save") {
      arguments.save = value();
    } else if (argument == "--peers") {
      std::string_view list = value();
      while (!list.empty()) {
        const std::size_t comma = std::min(list.find(','), list.size());
        arguments.peers.emplace_back(list.substr(0, comma));
        list.remove_prefix(std::min(comma + 1, list.size()));
      }
    } else if (argument.starts_with("-")) {
      stop(2, "unknown option " + std::string(argument));
    } else {
      arguments.files.emplace_back(argument);
    }
  }
  if (arguments.files.empty() || arguments.files.size() > 2)
    stop(2,
         "usage: cagecast_bench TARGET.glb CAGE.glb | FILE.scene [--preset paper|default] [--seams vertex|corner] "
         "[--runs 101]\n"
         "       [--peers embree,nanoflann,paper,default] [--json] [--save FILE.scene]");
  if (seams) arguments.options.seams = *seams;
  return arguments;
}

/// The library with another preset.
class OtherPreset : public Peer {
 public:
  explicit OtherPreset(const TransferOptions& options) : options_(options) {}
  Timings run(const MeshView& cage, const MeshView& target) override {
    if (const Status status = transfer(cage, target, options_, workspace_, result_); !status.ok())
      stop(1, describe(status, cage, target));
    return result_.projection.timings;
  }

 private:
  TransferOptions options_;
  Workspace workspace_;
  TransferResult result_;
};

std::unique_ptr<Peer> makePeer(const std::string& name) {
  if (name == "paper") return std::make_unique<OtherPreset>(TransferOptions::paper());
  if (name == "default") return std::make_unique<OtherPreset>(TransferOptions{});
  if (name == "nanoflann") return bench::makeNanoflannPeer();
  if (name != "embree") stop(2, "no peer \"" + name + "\"; there are: embree, nanoflann, paper, default");
  std::unique_ptr<Peer> peer = bench::makeEmbreePeer();
  if (!peer)
    stop(2, "this benchmark was built without Embree (Debian: libembree-dev); configure again once it is installed");
  return peer;
}

/// One step, as the library and its peers report it.
struct Stage {
  const char* name;
  double Timings::*time;
};
constexpr Stage kStages[] = {
    {"weld", &Timings::weld},         {"build", &Timings::build},     {"project", &Timings::project},
    {"occluded", &Timings::occluded}, {"covered", &Timings::covered}, {"segments", &Timings::segments},
    {"recheck", &Timings::recheck},   {"holes", &Timings::holes},     {"seams", &Timings::seams},
    {"classify", &Timings::classify}, {"total", &Timings::total}};

struct Spread {
  double median, min, max;
};

Spread spread(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return {(values[(n - 1) / 2] + values[n / 2]) / 2, values.front(), values.back()};
}

Spread spread(const std::vector<Timings>& runs, double Timings::*time) {
  std::vector<double> values;
  for (const Timings& t : runs) values.push_back(t.*time);
  return spread(std::move(values));
}

/// A peer, and the pairs of runs in which it was measured.
struct Contest {
  std::string name;
  std::unique_ptr<Peer> peer;
  std::vector<Timings> ours, theirs;

  /// Median of ours ÷ theirs over the pairs; 0 where a peer does not do the step.
  [[nodiscard]] double ratio(double Timings::*time) const {
    std::vector<double> ratios;
    for (std::size_t i = 0; i < ours.size(); ++i)
      if (theirs[i].*time > 0) ratios.push_back(ours[i].*time / theirs[i].*time);
    return ratios.empty() ? 0 : spread(std::move(ratios)).median;
  }
};

/// In how many vertices a peer's answer is another. 0 for a peer that gives none.
template <typename T>
std::size_t differences(const std::vector<T>& theirs, const Array<T>& ours) {
  std::size_t count = 0;
  for (std::size_t v = 0; v < theirs.size(); ++v) count += theirs[v] != ours[v];
  return count;
}

/// Keeps the process on one core, so that its runs see the same caches. Not every system allows it, and none needs it.
void pinToOneCore() {
  cpu_set_t cores;
  CPU_ZERO(&cores);
  CPU_SET(sched_getcpu(), &cores);
  sched_setaffinity(0, sizeof(cores), &cores);
}

std::string hashOf(const TransferResult& result) {
  Hash hash;
  hash.add(result);
  return hash.text();
}

std::uint32_t pointCount(const Projection& projection) {
  std::uint32_t sum = 0;
  for (const SegmentStats& segment : projection.segmentStats) sum += segment.points;
  return sum;
}

void printJson(const Arguments& arguments, const bench::Model& model, const TransferResult& result,
               const std::vector<Timings>& runs, const std::vector<Contest>& contests) {
  const auto stages = [](const std::vector<Timings>& timings) {
    std::string text;
    for (const Stage& stage : kStages) {
      const Spread s = spread(timings, stage.time);
      char line[128];
      std::snprintf(line, sizeof(line), "%s\"%s\":{\"median\":%.6f,\"min\":%.6f,\"max\":%.6f}", text.empty() ? "" : ",",
                    stage.name, s.median, s.min, s.max);
      text += line;
    }
    return "{" + text + "}";
  };
  std::printf(
      "{\"runs\":%d,\"compiler\":\"%s\",\"triangles\":%zu,\"vertices\":%zu,\"points\":%u,\"cageTriangles\":%zu,",
      arguments.runs, __VERSION__, model.target.indices.size() / 3, model.target.positions.size() / 3,
      pointCount(result.projection), model.cage.indices.size() / 3);
  std::printf("\"peakBytes\":%llu,\"hash\":\"%s\",\"cagecast\":%s,\"peers\":{",
              static_cast<unsigned long long>(result.projection.peakBytes), hashOf(result).c_str(),
              stages(runs).c_str());
  for (std::size_t i = 0; i < contests.size(); ++i) {
    const Contest& contest = contests[i];
    std::printf("%s\"%s\":{\"times\":%s,\"ratios\":{", i > 0 ? "," : "", contest.name.c_str(),
                stages(contest.theirs).c_str());
    bool first = true;
    for (const Stage& stage : kStages) {
      if (const double ratio = contest.ratio(stage.time); ratio > 0) {
        std::printf("%s\"%s\":%.4f", first ? "" : ",", stage.name, ratio);
        first = false;
      }
    }
    std::printf("},\"otherZones\":%zu,\"otherTriangles\":%zu}", differences(contest.peer->zones(), result.zones.zones),
                differences(contest.peer->triangles(), result.projection.triangles));
  }
  std::printf("}}\n");
}

void printTable(const bench::Model& model, const TransferResult& result, const std::vector<Timings>& runs,
                const std::vector<Contest>& contests) {
  std::printf("%zu triangles, %u points, cage of %zu triangles; %zu runs, CPU time in ms\n\n",
              model.target.indices.size() / 3, pointCount(result.projection), model.cage.indices.size() / 3,
              runs.size());
  std::printf("%-11s%10s%10s%10s", "", "median", "min", "max");
  for (const Contest& contest : contests) std::printf("%14s%10s", contest.name.c_str(), "ratio");
  std::printf("\n");
  for (const Stage& stage : kStages) {
    const Spread s = spread(runs, stage.time);
    std::printf("%-11s%10.4f%10.4f%10.4f", stage.name, s.median, s.min, s.max);
    for (const Contest& contest : contests)
      std::printf("%14.4f%10.3f", spread(contest.theirs, stage.time).median, contest.ratio(stage.time));
    std::printf("\n");
  }
  std::printf("\npeak %llu bytes above the inputs, hash %s\n",
              static_cast<unsigned long long>(result.projection.peakBytes), hashOf(result).c_str());
  for (const Contest& contest : contests) {
    if (contest.peer->zones().empty()) continue;
    std::printf("%s: another zone at %zu, another nearest triangle at %zu of %zu vertices\n", contest.name.c_str(),
                differences(contest.peer->zones(), result.zones.zones),
                differences(contest.peer->triangles(), result.projection.triangles), result.zones.zones.size());
  }
}

}  // namespace

int main(int argc, char** argv) {
  const Arguments arguments = parse(argc, argv);
  std::vector<Contest> contests;
  for (const std::string& name : arguments.peers) contests.push_back({name, makePeer(name), {}, {}});
  bench::Model model;
  if (const std::string error = bench::readModel(arguments.files, model); !error.empty()) stop(1, error);
  if (!arguments.save.empty()) {
    if (const std::string error = bench::writeScene(arguments.save, model); !error.empty()) stop(1, error);
    return 0;
  }
  const MeshView cage = model.cage.view();
  const MeshView target = model.target.view();

  pinToOneCore();
  Workspace workspace;
  TransferResult result;
  const auto runOurs = [&] {
    if (const Status status = transfer(cage, target, arguments.options, workspace, result); !status.ok())
      stop(1, describe(status, cage, target));
    return result.projection.timings;
  };
  // The first run takes memory, which later runs keep; it is not counted.
  runOurs();
  for (Contest& contest : contests) contest.peer->run(cage, target);
  std::vector<Timings> runs;
  for (int i = 0; i < arguments.runs; ++i) {
    if (contests.empty()) runs.push_back(runOurs());
    for (Contest& contest : contests) {
      contest.ours.push_back(runOurs());
      contest.theirs.push_back(contest.peer->run(cage, target));
      runs.push_back(contest.ours.back());
    }
  }
  if (arguments.json) {
    printJson(arguments, model, result, runs, contests);
  } else {
    printTable(model, result, runs, contests);
  }
}
