#include <nanoflann.hpp>

#include "peer.hpp"

namespace cagecast::bench {
namespace {

/// Points as nanoflann wants to see them.
struct Cloud {
  const float* positions = nullptr;
  std::size_t count = 0;

  [[nodiscard]] std::size_t kdtree_get_point_count() const { return count; }
  [[nodiscard]] float kdtree_get_pt(std::size_t point, std::size_t axis) const { return positions[3 * point + axis]; }
  template <typename Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Cloud>, Cloud, 3, std::uint32_t>;

class NanoflannPeer final : public Contestant {
 public:
  Timings run(const Model& model) override {
    Timings t;
    const Cloud cloud{model.cage.positions.data(), model.cage.positions.size() / 3};
    const auto tree = timed(t.build, [&] {
      return std::make_unique<Tree>(3, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(kLeafSize));
    });
    const std::vector<float>& points = model.points.positions;
    nearest_.resize(points.size() / 3);
    timed(t.project, [&] {
      for (std::size_t i = 0; i < nearest_.size(); ++i) {
        float squaredDistance = 0;
        tree->knnSearch(&points[3 * i], 1, &nearest_[i], &squaredDistance);
      }
    });
    t.total = t.build + t.project;
    return t;
  }

 private:
  /// Of 1, 2, 4, 8, 10, 16 and 32 the fastest in total at 4.8k.
  static constexpr std::size_t kLeafSize = 8;
  std::vector<std::uint32_t> nearest_;
};

}  // namespace

std::unique_ptr<Contestant> makeNanoflannPeer() { return std::make_unique<NanoflannPeer>(); }

}  // namespace cagecast::bench
