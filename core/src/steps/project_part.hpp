#pragma once

#include "cagecast/transfer.hpp"

namespace cagecast {

/// `project` for a target that is a part of another: does not look for outer borders of the cage.
Status projectPart(const MeshView& cage, const MeshView& target, const TransferOptions& options, Workspace& workspace,
                   Projection& out) noexcept;

}  // namespace cagecast
