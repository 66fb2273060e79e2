/// Makes, fits and refines cages natively, for measuring; bench/cages has the scripts around it.
///
///     cagecast_cages_tool make MODEL.json OUT.json [options]
///     cagecast_cages_tool landmarks MODEL.json OUT.json
///     cagecast_cages_tool fit TEMPLATE_CAGE.json TEMPLATE_LANDMARKS.json MODEL.json OUT.json [--landmarks L.json] …
///     cagecast_cages_tool refine CAGE.json MODEL.json OUT.json [--reach share]
///
/// Options: --kind head|body|prop, --triangles n, --voxels n, --closing share, --offset share (make); --exclude PATTERN
/// (make, fit; once per pattern; replaces the default list); --stages (the time of each stage on stderr).
/// MODEL.json: { positions, indices, groups, parts: [names], joints: [{ name, position, parent }], marks }; all but
/// the first two are optional. Landmarks: { name: [x, y, z] }. Cages: { positions, indices, uvs, landmarks }.
/// The last line on stdout is "TIME ms, OUTCOME". Exit code 1 if the function reports a problem, 2 for wrong usage.

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "cagecast/cages.hpp"

namespace {

using namespace cagecast;
using namespace cagecast::cages;
using nlohmann::json;

[[noreturn]] void stop(const std::string& message) {
  std::fprintf(stderr, "cagecast_cages_tool: %s\n", message.c_str());
  std::exit(2);
}

json readJson(const std::string& path) {
  std::ifstream file(path);
  if (!file) stop("cannot read " + path);
  json value = json::parse(file, nullptr, false);
  if (value.is_discarded()) stop(path + " is not JSON");
  return value;
}

void writeJson(const std::string& path, const json& value) {
  std::ofstream file(path);
  file << value << '\n';
  if (!file) stop("cannot write " + path);
}

template <typename T>
std::vector<T> arrayOf(const json& object, const char* name) {
  if (!object.contains(name) || object[name].is_null()) return {};
  return object[name].get<std::vector<T>>();
}

/// A model with the arrays that it refers to.
struct StoredModel {
  explicit StoredModel(const json& file)
      : positions(arrayOf<float>(file, "positions")),
        uvs(arrayOf<float>(file, "uvs")),
        indices(arrayOf<std::uint32_t>(file, "indices")),
        groups(arrayOf<std::uint32_t>(file, "groups")),
        marks(arrayOf<std::uint8_t>(file, "marks")) {
    model.mesh = {positions, indices, uvs, groups};
    model.parts = arrayOf<std::string>(file, "parts");
    model.marks = marks;
    for (const json& joint : file.value("joints", json::array()))
      model.joints.push_back({joint["name"], joint["position"].get<Position>(), joint["parent"]});
  }
  std::vector<float> positions, uvs;
  std::vector<std::uint32_t> indices, groups;
  std::vector<std::uint8_t> marks;
  Model model;
};

std::vector<Landmark> landmarksOf(const json& file) {
  std::vector<Landmark> landmarks;
  for (const auto& [name, position] : file.items()) landmarks.push_back({name, position.get<Position>(), 1});
  return landmarks;
}

json asJson(const std::vector<Landmark>& landmarks) {
  json out = json::object();
  for (const Landmark& landmark : landmarks) out[landmark.name] = landmark.position;
  return out;
}

json asJson(const Cage& cage) {
  return {{"positions", cage.positions},
          {"uvs", cage.uvs},
          {"indices", cage.indices},
          {"landmarks", asJson(cage.landmarks)}};
}

struct Arguments {
  std::string command;
  std::vector<std::string> files;
  std::string landmarks;  ///< A file, or empty.
  std::vector<std::string> exclude;
  MakeOptions make = {.exclude = {}};  ///< Patterns are in `exclude` above.
  RefineOptions refine;
  bool stages = false;
};

Kind kindOf(std::string_view name) {
  if (name == "head") return Kind::head;
  if (name == "body") return Kind::body;
  if (name == "prop") return Kind::prop;
  stop("no kind \"" + std::string(name) + "\"; there are: head, body, prop");
}

Arguments parse(int argc, char** argv) {
  if (argc < 2) stop("say make, landmarks, fit or refine");
  Arguments arguments;
  arguments.command = argv[1];
  for (int i = 2; i < argc; ++i) {
    const std::string argument = argv[i];
    const auto value = [&] {
      if (++i == argc) stop(argument + " needs a value");
      return std::string(argv[i]);
    };
    const auto number = [&] { return std::strtod(value().c_str(), nullptr); };
    MakeOptions& make = arguments.make;
    if (argument == "--landmarks")
      arguments.landmarks = value();
    else if (argument == "--exclude")
      arguments.exclude.push_back(value());
    else if (argument == "--kind")
      make.kind = kindOf(value());
    else if (argument == "--triangles")
      make.triangles = static_cast<std::uint32_t>(number());
    else if (argument == "--voxels")
      make.voxels = static_cast<std::uint32_t>(number());
    else if (argument == "--closing")
      make.closing = static_cast<float>(number());
    else if (argument == "--offset")
      make.offset = static_cast<float>(number());
    else if (argument == "--reach")
      arguments.refine.reach = static_cast<float>(number());
    else if (argument == "--stages")
      arguments.stages = true;
    else if (argument.starts_with("-"))
      stop("no option " + argument);
    else
      arguments.files.push_back(argument);
  }
  return arguments;
}

using Clock = std::chrono::steady_clock;

double millisecondsSince(Clock::time_point began) {
  return std::chrono::duration<double, std::milli>(Clock::now() - began).count();
}

/// Times the stages that a call reports, and the longest time between two reports.
class StageClock {
 public:
  explicit StageClock(bool print) : print_(print) {}
  ~StageClock() {
    finish();
    if (print_) std::fprintf(stderr, "longest time without a report: %.0f ms\n", longest_);
  }

  Progress progress() {
    return [this](float share, const char* stage) {
      longest_ = std::max(longest_, millisecondsSince(last_));
      last_ = Clock::now();
      if (stage_ != stage) {
        finish();
        stage_ = stage;
        began_ = last_;
        from_ = share;
      }
      share_ = share;
      return true;
    };
  }

 private:
  void finish() const {
    if (print_ && !stage_.empty())
      std::fprintf(stderr, "%8.0f ms  %-24s %.3f..%.3f\n", millisecondsSince(began_), stage_.c_str(), from_, share_);
  }
  bool print_;
  std::string stage_;
  Clock::time_point began_ = Clock::now(), last_ = Clock::now();
  float from_ = 0, share_ = 0;
  double longest_ = 0;
};

/// Prints time and outcome; the exit code.
int report(double milliseconds, const Outcome& outcome) {
  std::printf("%.0f ms, %s\n", milliseconds, outcome.ok() ? "ok" : outcome.message.c_str());
  return outcome.ok() ? 0 : 1;
}

const char* nameOf(Kind kind) {
  constexpr const char* kNames[] = {"automatic", "head", "body", "prop"};
  return kNames[static_cast<std::size_t>(kind)];
}

int runMake(const Arguments& arguments) {
  const StoredModel stored(readJson(arguments.files[0]));
  MakeOptions options = arguments.make;
  options.exclude = arguments.exclude.empty() ? defaultExclusions() : arguments.exclude;
  StageClock stages(arguments.stages);
  Cage cage;
  const auto began = Clock::now();
  const Outcome outcome = makeCage(stored.model, options, stages.progress(), cage);
  const double time = millisecondsSince(began);
  if (outcome.ok()) writeJson(arguments.files[1], asJson(cage));
  return report(time, outcome);
}

int runLandmarks(const Arguments& arguments) {
  const StoredModel stored(readJson(arguments.files[0]));
  StageClock stages(arguments.stages);
  FoundLandmarks found;
  const auto began = Clock::now();
  const Outcome outcome = findLandmarks(stored.model, stages.progress(), found);
  const double time = millisecondsSince(began);
  if (outcome.ok()) {
    json confidence = json::object();
    for (const Landmark& landmark : found.landmarks) confidence[landmark.name] = landmark.confidence;
    writeJson(arguments.files[1], {{"landmarks", asJson(found.landmarks)},
                                   {"confidence", confidence},
                                   {"missing", found.missing},
                                   {"rig", found.rig},
                                   {"kind", nameOf(found.kind)}});
  }
  return report(time, outcome);
}

int runFit(const Arguments& arguments) {
  const StoredModel cageFile(readJson(arguments.files[0]));
  const Template from{cageFile.model.mesh, landmarksOf(readJson(arguments.files[1]))};
  const StoredModel stored(readJson(arguments.files[2]));
  const json given = arguments.landmarks.empty() ? json::object() : readJson(arguments.landmarks);
  FitOptions options;
  if (!arguments.exclude.empty()) options.exclude = arguments.exclude;
  StageClock stages(arguments.stages);
  options.landmarks = landmarksOf(given);
  FittedCage cage;
  const auto began = Clock::now();
  const Outcome outcome = fitCage(from, stored.model, options, stages.progress(), cage);
  const double time = millisecondsSince(began);
  if (outcome.ok()) {
    json out = asJson(cage);
    out["used"] = asJson(cage.landmarks);
    out["missing"] = cage.missing;
    writeJson(arguments.files[3], out);
  }
  return report(time, outcome);
}

int runRefine(const Arguments& arguments) {
  const StoredModel cageFile(readJson(arguments.files[0]));
  const StoredModel stored(readJson(arguments.files[1]));
  StageClock stages(arguments.stages);
  Cage cage;
  const auto began = Clock::now();
  const Outcome outcome = refineCage(cageFile.model.mesh, stored.model, arguments.refine, stages.progress(), cage);
  const double time = millisecondsSince(began);
  if (outcome.ok()) writeJson(arguments.files[2], asJson(cage));
  return report(time, outcome);
}

}  // namespace

int main(int argc, char** argv) {
  struct Command {
    std::string_view name;
    std::size_t files;
    int (*run)(const Arguments&);
  };
  const std::vector<Command> commands = {
      {"make", 2, runMake},
      {"landmarks", 2, runLandmarks},
      {"fit", 4, runFit},
      {"refine", 3, runRefine},
  };
  const Arguments arguments = parse(argc, argv);
  for (const Command& command : commands) {
    if (command.name != arguments.command) continue;
    if (command.files != arguments.files.size()) stop("wrong number of files; see bench/native/cages.cpp");
    return command.run(arguments);
  }
  stop("no command \"" + arguments.command + "\"; there are: make, landmarks, fit, refine");
}
