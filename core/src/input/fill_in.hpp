#pragma once

#include <string>
#include <string_view>

namespace cagecast {

/// A sentence of codes.def with values in the place of their names in braces.
/// @param valueOf  Returns the value of a name.
template <typename ValueOf>
std::string fillIn(std::string_view sentence, const ValueOf& valueOf) {
  std::string out;
  for (auto open = sentence.find('{'); open != std::string_view::npos; open = sentence.find('{')) {
    const auto close = sentence.find('}');
    out.append(sentence.substr(0, open));
    out.append(valueOf(sentence.substr(open + 1, close - open - 1)));
    sentence.remove_prefix(close + 1);
  }
  return out.append(sentence);
}

}  // namespace cagecast
