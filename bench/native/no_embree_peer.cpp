// Stands in for embree_peer.cpp where Embree is not installed.
#include "peer.hpp"

namespace cagecast::bench {

std::unique_ptr<Peer> makeEmbreePeer() { return nullptr; }

}  // namespace cagecast::bench
