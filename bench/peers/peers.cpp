#include "bench/peers/peer.h"

#include <array>

#include "bench/peers/simulator.h"

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

std::vector<SimulatorRow> simulators() {
#ifdef DELASSUS_PEER_MUJOCO
  return mujoco_simulators();
#else
  return {};
#endif
}

Constraint contact_in_world(const Poses<double>& at, Index body, Index other, const Vector3<double>& point, const Matrix3<double>& axes, double friction) {
  Constraint c;
  c.kind = Constraint::Kind::contact;
  c.friction = friction;
  const auto in = [&](Index b) {
    const Pose<double> pose = world_pose(at, b);
    return Frame{b, {pose.rotation.transpose() * axes, pose.rotation.transpose() * (point - pose.translation)}};
  };
  c.a = in(body), c.b = in(other);
  return c;
}

}  // namespace delassus::bench
