#pragma once

#include <exception>
#include <new>
#include <sstream>
#include <string>

#include "gltf.hpp"

namespace cagecast::gltf {

/// Thrown for a broken file; `guarded` catches it.
struct Problem {
  std::string text;
};

/// Throws a `Problem` whose text is the parts, one after the other.
template <typename... Parts>
[[noreturn]] void fail(const Parts&... parts) {
  std::ostringstream text;
  (text << ... << parts);
  throw Problem{text.str()};
}

/// Runs work that may fail, and turns whatever it throws into an error about a file.
/// @param unknown  What to say of the file if a library throws: "is not valid glTF".
template <typename Work>
Result guarded(const std::string& name, const char* unknown, Work work) {
  try {
    work();
    return {};
  } catch (const Problem& problem) {
    return {name + ": " + problem.text};
  } catch (const std::bad_alloc&) {
    return {name + ": not enough memory"};
  } catch (const std::exception& error) {
    return {name + ": " + unknown + " (" + error.what() + ")"};
  }
}

}  // namespace cagecast::gltf
