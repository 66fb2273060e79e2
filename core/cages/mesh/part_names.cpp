#include "mesh/part_names.hpp"

#include <algorithm>

namespace cagecast::cages {

namespace {

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

}  // namespace

bool matches(std::string_view name, std::string_view pattern) noexcept {
  // Only the last star can have to take more: what stands before it has found its first place already.
  std::size_t n = 0, p = 0, star = std::string_view::npos, resume = 0;
  while (n < name.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      resume = n;
    } else if (p < pattern.size() && (pattern[p] == '?' || lower(pattern[p]) == lower(name[n]))) {
      ++n;
      ++p;
    } else if (star != std::string_view::npos) {
      p = star + 1;
      n = ++resume;
    } else {
      return false;
    }
  }
  while (p < pattern.size() && pattern[p] == '*') ++p;
  return p == pattern.size();
}

std::vector<bool> matchingParts(const std::vector<std::string>& parts, const std::vector<std::string>& patterns) {
  std::vector<bool> out(parts.size(), false);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const std::string_view name = parts[i];
    for (const std::string& pattern : patterns) {
      out[i] = out[i] || matches(name, pattern);
      for (std::size_t begin = 0; begin < name.size() && !out[i];) {
        const std::size_t end = std::min(name.find('/', begin), name.size());
        out[i] = matches(name.substr(begin, end - begin), pattern);
        begin = end + 1;
      }
    }
  }
  return out;
}

std::vector<bool> trianglesOf(const MeshView& mesh, const std::vector<bool>& isMatch) {
  std::vector<bool> out(mesh.indices.size() / 3, false);
  if (mesh.groups.empty()) return out;
  for (std::size_t t = 0; t < out.size(); ++t) {
    const std::uint32_t group = mesh.groups[mesh.indices[3 * t]];
    out[t] = group < isMatch.size() && isMatch[group];
  }
  return out;
}

}  // namespace cagecast::cages
