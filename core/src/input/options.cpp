#include <algorithm>
#include <cstddef>
#include <iterator>
#include <type_traits>

#include "input/option_list.hpp"
#include "input/validate.hpp"

namespace cagecast {
namespace {

template <typename... Values>
constexpr double lowest(Values... values) {
  const double all[] = {static_cast<double>(values)...};
  return all[0];
}
template <typename... Values>
constexpr double highest(Values... values) {
  const double all[] = {static_cast<double>(values)...};
  return all[sizeof...(values) - 1];
}

/// Whether the names of a choice are the enumerators of its type, in order.
template <typename... Values>
constexpr bool areInOrder(Values... values) {
  int next = 0;
  return (!std::is_enum_v<Values> && ...) || ((static_cast<int>(values) == next++) && ...);
}

// NOLINTBEGIN(bugprone-macro-parentheses): the arguments are types, names and lists.
// Opens a function in whose scope the names of a range are known.
#define CAGECAST_SCOPE_share [] {
#define CAGECAST_SCOPE_length [] {
#define CAGECAST_SCOPE_toggle [] {
#define CAGECAST_SCOPE_choice(type) [] { using enum type;
#define CAGECAST_NAMES_share(range) nullptr
#define CAGECAST_NAMES_length(range) nullptr
#define CAGECAST_NAMES_toggle(range) nullptr
#define CAGECAST_NAMES_choice(type) CAGECAST_QUOTE
#define CAGECAST_QUOTE(range) #range

// clang-format off
#define CAGECAST_ENTRY(stage, path, field, kind, range)                                                 \
  {Option::field, Stage::stage, path #field,                                                            \
   CAGECAST_SCOPE_##kind return lowest range; }(), CAGECAST_SCOPE_##kind return highest range; }(),     \
   CAGECAST_NAMES_##kind(range), [](const TransferOptions& options) {                                   \
     static_assert(CAGECAST_SCOPE_##kind return areInOrder range; }(), "not the enumerators of " #kind);
#define CAGECAST_OPTION(stage, name, kind, standard, paper, range, text) \
  CAGECAST_ENTRY(stage, "", name, kind, range) return static_cast<double>(options.name); }},
#define CAGECAST_STEP(stage, name, kind, standard, paper, range, text) \
  CAGECAST_ENTRY(stage, "steps.", name, kind, range) return static_cast<double>(options.steps.name); }},
constexpr OptionEntry kEntries[] = {
#include "cagecast/options.def"
};
// clang-format on
// NOLINTEND(bugprone-macro-parentheses)

}  // namespace

const OptionEntry* findOption(Option option) noexcept {
  const auto* end = std::end(kEntries);
  const auto* found = std::find_if(kEntries, end, [=](const OptionEntry& entry) { return entry.option == option; });
  return found == end ? nullptr : found;
}

const char* optionName(Option option) noexcept {
  if (option == Option::locks) return "locks";
  if (option == Option::ignoredParts) return "parts.ignore";
  if (option == Option::keptParts) return "parts.keep";
  if (option == Option::excludedParts) return "parts.exclude";
  if (option == Option::vertexMasks) return "masks.vertices";
  if (option == Option::triangleMasks) return "masks.triangles";
  const OptionEntry* entry = findOption(option);
  return entry == nullptr ? "none" : entry->name;
}

Status checkOptions(const TransferOptions& options, Stage stage) noexcept {
  for (const OptionEntry& entry : kEntries) {
    if (entry.stage != stage) continue;
    const double value = entry.valueIn(options);
    if (value >= entry.low && value <= entry.high) continue;  // Also false for NaN.
    return {Code::badOption, Argument::options, 0, entry.option, static_cast<float>(value)};
  }
  return {};
}

Status checkOptions(const TransferOptions& options) noexcept {
  const Status status = checkOptions(options, Stage::project);
  return status.ok() ? checkOptions(options, Stage::classify) : status;
}

Status resolveLocks(const TransferOptions& options, std::span<const SegmentStats> stats, Array<Lock>& out) noexcept {
  const Parts& parts = options.parts;
  const bool isAny = !options.locks.empty() || !parts.keep.empty() || !parts.exclude.empty();
  if (!out.reset(isAny ? stats.size() : 0)) return {Code::outOfMemory};
  std::fill(out.begin(), out.end(), Lock::automatic);
  const auto lockGroups = [&](std::span<const std::uint32_t> groups, Lock lock, Option option) -> Status {
    for (const std::uint32_t group : groups) {
      bool isKnown = false;
      for (std::size_t s = 0; s < stats.size(); ++s) {
        if (stats[s].group != group) continue;
        out[s] = lock;
        isKnown = true;
      }
      if (!isKnown) return {Code::badOption, Argument::options, group, option};
    }
    return {};
  };
  if (const Status status = lockGroups(parts.exclude, Lock::exclude, Option::excludedParts); !status.ok())
    return status;
  if (const Status status = lockGroups(parts.keep, Lock::keep, Option::keptParts); !status.ok()) return status;
  for (const auto& [segment, lock] : options.locks) {
    if (lock > Lock::exclude)
      return {Code::badOption, Argument::options, segment, Option::locks, static_cast<float>(lock)};
    if (segment >= stats.size()) return {Code::badOption, Argument::options, segment, Option::locks};
    out[segment] = lock;
  }
  return {};
}

}  // namespace cagecast
