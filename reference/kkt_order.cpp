#include "reference/kkt_order.h"

#include <camd.h>

#include <Eigen/Cholesky>

#include <algorithm>
#include <stdexcept>

namespace delassus::reference {

namespace {

constexpr double enough_damping = 0x1p-30;  // steers the order only; pivots and residuals decide about the result

/// One constraint, of links or of a joint, as a node of the graph.
struct Node {
  Index row, rows;
  std::vector<Index> bodies;
  MatrixX<double> mobility;  // Σ K_i H_i⁻¹ K_iᵀ, or of the joint alone: a bound or an estimate of its block of A0
};

std::vector<Node> nodes(const Problem<double>& p) {
  const Structure& s = *p.structure;
  std::vector<Node> out;
  for (const auto& e : s.link_constraints) {
    Node node{e.row, e.rows, {}, MatrixX<double>::Zero(e.rows, e.rows)};
    for (const auto& link : e.links) {
      MatrixX<double> K(e.rows, 6);
      for (Index r = 0; r < e.rows; ++r) K.row(r) = p.K[link.first + r].transpose();
      const Matrix6<double> H = p.H[link.body];
      node.mobility += K * H.ldlt().solve(K.transpose());
      node.bodies.push_back(link.body);
    }
    out.push_back(std::move(node));
  }
  for (const auto& j : s.joint_constraints) {
    Node node{j.row, j.rows, {j.body}, MatrixX<double>::Zero(j.rows, j.rows)};
    const Index n = s.dofs(j.body);
    for (Index k = 0; k < n; ++k) {
      const Vector6<double>& S = p.S[s.first_dof[j.body] + k];
      const double inertia = S.dot(p.H[j.body] * S) + p.armature[s.first_dof[j.body] + k];
      for (Index r = 0; r < j.rows; ++r) {
        const double entry = p.joint_K[j.first + r * n + k];
        node.mobility(r, r) += entry * entry / inertia;
      }
    }
    out.push_back(std::move(node));
  }
  return out;
}

/// Whether −R⁻¹ of these rows may be a pivot before anything else is eliminated.
bool early(const Node& node, const Damping<double>& damping) {
  MatrixX<double> R_inverse = MatrixX<double>::Zero(node.rows, node.rows);
  for (Index r = 0; r < node.rows; ++r) R_inverse(r, r) = damping.diagonal[node.row + r];
  bool coupled = false;
  auto block = std::lower_bound(damping.blocks.begin(), damping.blocks.end(), node.row,
                                [](const auto& b, Index row) { return b.row < row; });
  for (; block != damping.blocks.end() && block->row < node.row + node.rows; ++block) {
    const Index first = block->row - node.row, n = block->R_inverse.rows();
    R_inverse.block(first, first, n, n) += block->R_inverse;
    coupled = true;
  }
  for (Index r = 0; r < node.rows; ++r)
    if (!(R_inverse(r, r) > enough_damping * node.mobility(r, r))) return false;
  if (!coupled) return true;
  R_inverse.diagonal() -= enough_damping * node.mobility.diagonal();
  return R_inverse.llt().info() == Eigen::Success;
}

/// CAMD on the graph of bodies (nodes 0…N−1; edges to parents) and constraints (edges to their bodies).
std::vector<int> group_order(const Structure& s, const std::vector<Node>& constraints, const Damping<double>& damping) {
  const std::size_t bodies = s.parent.size(), count = bodies + constraints.size();
  std::vector<int> begin{0}, neighbour, set(count, 0);
  for (std::size_t i = 0; i < bodies; ++i) {
    if (s.parent[i] != ground) neighbour.push_back(static_cast<int>(s.parent[i]));
    begin.push_back(static_cast<int>(neighbour.size()));
  }
  for (std::size_t e = 0; e < constraints.size(); ++e) {
    for (const Index i : constraints[e].bodies) neighbour.push_back(static_cast<int>(i));
    begin.push_back(static_cast<int>(neighbour.size()));
    set[bodies + e] = early(constraints[e], damping) ? 0 : 1;
  }
  std::vector<int> order(count);
  if (count == 0) return order;
  neighbour.push_back(0);  // CAMD wants an array even when there is no edge
  const int status = camd_order(static_cast<int>(count), begin.data(), neighbour.data(), order.data(), nullptr, nullptr, set.data());
  if (status != CAMD_OK && status != CAMD_OK_BUT_JUMBLED) throw std::runtime_error("kkt_cholmod: CAMD failed");
  return order;
}

}  // namespace

std::vector<int> kkt_order(const Problem<double>& problem, const Damping<double>& damping, bool with_rows) {
  const Structure& s = *problem.structure;
  const KktLayout layout{s.bodies(), s.dofs(), s.rows};
  const std::vector<Node> constraints = with_rows ? nodes(problem) : std::vector<Node>{};
  std::vector<int> unknowns;
  const auto append = [&](Index first, Index count) {
    for (Index k = 0; k < count; ++k) unknowns.push_back(static_cast<int>(first + k));
  };
  for (const int group : group_order(s, constraints, damping)) {
    if (group < s.bodies()) {
      append(layout.a(group), 6);
      append(layout.phi(group), 6);
      append(layout.nu(s.first_dof[group]), s.dofs(group));
    } else {
      const Node& e = constraints[static_cast<std::size_t>(group - s.bodies())];
      append(layout.mu(e.row), e.rows);
    }
  }
  return unknowns;
}

}  // namespace delassus::reference
