#pragma once

#include <cstdint>
#include <vector>

#include "cagecast/cages.hpp"

namespace cagecast::cages {

/// A model without its grounds and backdrops: connected pieces that are flat, wider than all the rest, and below or
/// beside it. A cage around them would have room for little else.
class Foreground {
 public:
  /// @param model  Checked by `checkModel`. Must outlive this.
  explicit Foreground(const Model& model);
  Foreground(const Foreground&) = delete;
  Foreground& operator=(const Foreground&) = delete;

  [[nodiscard]] const Model& model() const noexcept { return model_; }

 private:
  Model model_;
  std::vector<std::uint32_t> indices_;
  std::vector<std::uint8_t> marks_;
};

}  // namespace cagecast::cages
