#pragma once

#include <cstdint>
#include <string>

#include "cagecast/mesh.hpp"
#include "cagecast/options.hpp"

namespace cagecast {

/// What went wrong; `ok` if nothing did. codes.def says what each code means.
enum class Code : std::uint8_t {
#define CAGECAST_CODE(name, text, sentence) name,
#define CAGECAST_CAGES_CODE(name, text, sentence) name,
#include "cagecast/codes.def"
};

/// Which argument of a call is at fault.
enum class Argument : std::uint8_t {
  none,
  cage,
  target,
  options,
  model,  ///< This and the others: of cages.hpp.
  from,   ///< A template.
  landmarks,
};

/// How a call ended: an error as a value. Unless `ok()`, nothing in the output of the call is valid.
struct [[nodiscard]] Status {
  Code code = Code::ok;
  Argument argument = Argument::none;  ///< The argument at fault.
  std::uint32_t at = 0;                ///< The element at fault, or a count: codes.def says which; else 0.
  Option option = Option::none;        ///< With an argument `options`: the option at fault.
  float value = 0;                     ///< The value that was given for it; for a choice, its number.
                                       ///< With another argument: codes.def says what, if anything.
  [[nodiscard]] constexpr bool ok() const noexcept { return code == Code::ok; }
};

/// The name of a code as it is spelled in codes.def ("indexOutOfRange"): stable, for programs.
const char* codeName(Code code) noexcept;

/// The name of an argument: "cage", "target", "options", "model", "template", "landmarks"; empty if there is none.
const char* argumentName(Argument argument) noexcept;

/// The name of an option as users write it after `options.`: "threshold", "steps.floor", "parts.ignore".
const char* optionName(Option option) noexcept;

/// One sentence for people that names the argument, the element, its value and the limit:
/// `target.indices[17] = 912 is out of range (900 vertices)`.
/// @param cage,target  The meshes of the call that returned `status`. Of what they lack, the sentence gives no value.
std::string describe(const Status& status, const MeshView& cage, const MeshView& target);

}  // namespace cagecast
