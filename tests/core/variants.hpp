#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "cagecast/options.hpp"
#include "scenes/scenes.hpp"

/// Options for tests of all of them: both follow options.def, so that a new option is tested, too.
namespace cagecast {

/// `paper`, `default`, and each option of `default` as an addition to `paper`.
inline std::vector<std::pair<std::string, TransferOptions>> variants() {
  constexpr TransferOptions standard, paper = TransferOptions::paper();
  std::vector<std::pair<std::string, TransferOptions>> all{{"paper", paper}, {"default", standard}};
#define CAGECAST_ADD(field)                   \
  if (standard.field != paper.field) {        \
    all.emplace_back(#field, paper);          \
    all.back().second.field = standard.field; \
  }
#define CAGECAST_OPTION(stage, name, ...) CAGECAST_ADD(name)
#define CAGECAST_STEP(stage, name, ...) CAGECAST_ADD(steps.name)
#include "cagecast/options.def"
#undef CAGECAST_ADD
  return all;
}

/// Any options, of which half are as in `paper`.
inline TransferOptions anyOptions(scenes::Random& random) {
  TransferOptions options = TransferOptions::paper();
  const auto flip = [&] { return random.below(2) == 0; };
// A share of 0 asks for nothing; then the library does not look again where nothing is covered.
#define CAGECAST_VARY_share(field, low, high) \
  if (flip()) options.field = random.between(0.01f, high);
#define CAGECAST_VARY_length(field, low, high) \
  if (flip()) options.field = random.between(low, std::min(0.1f, static_cast<float>(high)));
#define CAGECAST_VARY_toggle(field, low, high) options.field = flip();
#define CAGECAST_VARY_choice(type) CAGECAST_VARY_NOTHING
#define CAGECAST_VARY_NOTHING(field, low, high)
#define CAGECAST_VARY(kind, field, range) CAGECAST_VARY_WITH(CAGECAST_VARY_##kind, field, CAGECAST_PAIR range)
#define CAGECAST_VARY_WITH(vary, ...) CAGECAST_VARY_CALL(vary, __VA_ARGS__)
#define CAGECAST_VARY_CALL(vary, ...) vary(__VA_ARGS__)
#define CAGECAST_PAIR(low, high) low, high
#define CAGECAST_OPTION(stage, name, kind, standard, paper, range, text) CAGECAST_VARY(kind, name, range)
#define CAGECAST_STEP(stage, name, kind, standard, paper, range, text) CAGECAST_VARY(kind, steps.name, range)
#include "cagecast/options.def"
  options.seams = flip() ? Seams::corner : Seams::vertex;
  return options;
}

}  // namespace cagecast
