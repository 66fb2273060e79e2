/// Measures the library, and peers beside it, in CPU time, and prints JSON.
///
///     cagecast_bench FILE.scene [--contestants paper,default,embree,nanoflann] [--runs 101]
///
/// All contestants take turns, so that what else the machine does falls on all alike. `paper` and `default` are the
/// library: the whole work from raw arrays to zones. Exit code 1 if the input is unusable, 2 for wrong usage; a line on
/// stderr says why.

#include <sched.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "hash.hpp"
#include "model.hpp"
#include "peer.hpp"

namespace {

using namespace cagecast;
using bench::Contestant;

[[noreturn]] void stop(int exitCode, const std::string& message) {
  std::fprintf(stderr, "cagecast_bench: %s\n", message.c_str());
  std::exit(exitCode);
}

/// The library with one of its presets.
class Library final : public Contestant {
 public:
  explicit Library(const TransferOptions& options) : options_(options) {}
  Timings run(const bench::Model& model) override {
    const MeshView cage = model.cage.view();
    const MeshView target = model.target.view();
    if (const Status status = transfer(cage, target, options_, workspace_, result_); !status.ok())
      stop(1, describe(status, cage, target));
    return result_.projection.timings;
  }
  /// In how many vertices a peer says another zone. What is culled, which needs segments, peers do not decide.
  [[nodiscard]] std::size_t differences(const std::vector<Zone>& zones, const bench::Points& points) const {
    std::size_t count = 0;
    for (std::size_t v = 0; v < points.ofVertex.size(); ++v) {
      const Zone ours = result_.zones.zones[v];
      count += zones[points.ofVertex[v]] != (ours == Zone::culled ? Zone::cosmetic : ours);
    }
    return count;
  }
  [[nodiscard]] const TransferResult& result() const { return result_; }

 private:
  TransferOptions options_;
  Workspace workspace_;
  TransferResult result_;
};

const std::map<std::string, std::function<std::unique_ptr<Contestant>()>> kContestants = {
    {"paper", [] { return std::make_unique<Library>(TransferOptions::paper()); }},
    {"default", [] { return std::make_unique<Library>(TransferOptions{}); }},
    {"nanoflann", bench::makeNanoflannPeer},
#ifdef CAGECAST_BENCH_EMBREE
    {"embree", bench::makeEmbreePeer},
#endif
};

/// Keeps the process on one core, so that its runs see the same caches. Not every system allows it, and none needs it.
void pinToOneCore() {
  cpu_set_t cores;
  CPU_ZERO(&cores);
  CPU_SET(sched_getcpu(), &cores);
  sched_setaffinity(0, sizeof(cores), &cores);
}

struct Stage {
  const char* name;
  double Timings::*time;
};
constexpr Stage kStages[] = {
    {"weld", &Timings::weld},         {"build", &Timings::build},       {"project", &Timings::project},
    {"occluded", &Timings::occluded}, {"covered", &Timings::covered},   {"segments", &Timings::segments},
    {"recheck", &Timings::recheck},   {"motion", &Timings::motion},     {"holes", &Timings::holes},
    {"seams", &Timings::seams},       {"classify", &Timings::classify}, {"total", &Timings::total}};

/// The times of each step in milliseconds, run by run.
std::string timesOf(const std::vector<Timings>& runs) {
  std::string text;
  for (const Stage& stage : kStages) {
    text += std::string(text.empty() ? "" : ",") + '"' + stage.name + "\":[";
    for (std::size_t i = 0; i < runs.size(); ++i) {
      char time[32];
      std::snprintf(time, sizeof(time), "%s%.6f", i > 0 ? "," : "", runs[i].*stage.time);
      text += time;
    }
    text += "]";
  }
  return "{" + text + "}";
}

struct Arguments {
  std::string file;
  std::vector<std::string> contestants = {"paper"};
  int runs = 101;
};

Arguments parse(int argc, char** argv) {
  Arguments arguments;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--runs" && i + 1 < argc) {
      arguments.runs = std::max(1, std::atoi(argv[++i]));
    } else if (argument == "--contestants" && i + 1 < argc) {
      arguments.contestants.clear();
      std::istringstream list(argv[++i]);
      for (std::string name; std::getline(list, name, ',');) {
        if (kContestants.count(name) == 0) stop(2, "no contestant \"" + name + "\", or built without its library");
        arguments.contestants.push_back(name);
      }
    } else if (argument.starts_with("-") || !arguments.file.empty()) {
      stop(2, "usage: cagecast_bench FILE.scene [--contestants paper,default,embree,nanoflann] [--runs 101]");
    } else {
      arguments.file = argument;
    }
  }
  return arguments;
}

}  // namespace

int main(int argc, char** argv) {
  const Arguments arguments = parse(argc, argv);
  bench::Model model;
  if (const std::string error = bench::readModel(arguments.file, model); !error.empty()) stop(1, error);
  pinToOneCore();
  std::vector<std::unique_ptr<Contestant>> contestants;
  for (const std::string& name : arguments.contestants) contestants.push_back(kContestants.at(name)());
  // The first run takes memory, which later runs keep; it is not counted.
  for (const auto& contestant : contestants) contestant->run(model);
  std::vector<std::vector<Timings>> runs(contestants.size());
  for (int i = 0; i < arguments.runs; ++i)
    for (std::size_t c = 0; c < contestants.size(); ++c) runs[c].push_back(contestants[c]->run(model));

  std::printf("{\"compiler\":\"%s\",\"triangles\":%zu,\"vertices\":%zu,\"points\":%zu,\"cageTriangles\":%zu",
              __VERSION__, model.target.indices.size() / 3, model.points.ofVertex.size(),
              model.points.positions.size() / 3, model.cage.indices.size() / 3);
  const Library* first = nullptr;  // Peers are compared with it.
  std::printf(",\"contestants\":{");
  for (std::size_t c = 0; c < contestants.size(); ++c) {
    std::printf("%s\"%s\":{\"times\":%s", c > 0 ? "," : "", arguments.contestants[c].c_str(), timesOf(runs[c]).c_str());
    if (const auto* library = dynamic_cast<const Library*>(contestants[c].get())) {
      if (first == nullptr) first = library;
      Hash hash;
      hash.add(library->result());
      std::printf(",\"hash\":\"%s\",\"peakBytes\":%llu", hash.text().c_str(),
                  static_cast<unsigned long long>(library->result().projection.peakBytes));
    } else if (first != nullptr && !contestants[c]->zones().empty()) {
      std::printf(",\"otherZones\":%zu", first->differences(contestants[c]->zones(), model.points));
    }
    std::printf("}");
  }
  std::printf("}}\n");
}
