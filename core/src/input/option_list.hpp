#pragma once

#include <string>

#include "cagecast/options.hpp"
#include "cagecast/status.hpp"
#include "input/validate.hpp"

namespace cagecast {

/// What options.def says about an option.
struct OptionEntry {
  Option option;
  Stage stage;
  const char* name;   ///< As users write it: "threshold", "steps.floor".
  double low, high;   ///< The values allowed; of a choice, the numbers of its first and last name.
  const char* names;  ///< Of a choice, its names in parentheses: "(vertex, corner)"; else null.
  double (*valueIn)(const TransferOptions& options);
};

/// @return Null for `Option::none` and for locks, which are not in options.def.
const OptionEntry* findOption(Option option) noexcept;

}  // namespace cagecast
