#include "bench/peers/peer.h"

#include <array>

namespace delassus::bench {

const char* name(Step s) {
  constexpr std::array<const char*, step_count> names{"kinematics", "first_product", "product", "first_solve", "solve", "new_damping"};
  return names[static_cast<std::size_t>(s)];
}

std::vector<PeerRow> peers() {
  std::vector<PeerRow> all;
  [[maybe_unused]] const auto add = [&](const std::vector<PeerRow>& some) { all.insert(all.end(), some.begin(), some.end()); };
#ifdef DELASSUS_PEER_PINOCCHIO
  add(pinocchio_peers());
#endif
#ifdef DELASSUS_PEER_MUJOCO
  add(mujoco_peers());
#endif
  return all;
}

}  // namespace delassus::bench
