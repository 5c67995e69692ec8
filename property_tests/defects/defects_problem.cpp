// Defects in which the mechanism is misread: the tree, the bodies, the joints, the constraints.
#include "property_tests/defects/defects_wrong.h"

namespace delassus::laws {
namespace {

template <class T> Index root(const T& s, Index body) {
  while (s.parent[static_cast<std::size_t>(body)] != ground) body = s.parent[static_cast<std::size_t>(body)];
  return body;
}

std::vector<DefectRow> tree_defects() {
  constexpr Place in = Place::structure;
  return {
      defect<in>("grandparent_as_parent", "π(π(i)) in place of π(i)", [](Structure& s) {
        for (std::size_t i = s.parent.size(); i-- > 0;)
          if (const Index p = s.parent[i]; p != ground) s.parent[i] = s.parent[static_cast<std::size_t>(p)];
      }),
      defect<in>("sibling_as_parent", "of several children of a body, each is hung on the one before", [](Structure& s) {
        const std::vector<Index> right = s.parent;
        for (std::size_t i = 1; i < right.size(); ++i)
          for (std::size_t j = 0; j < i; ++j)
            if (right[j] == right[i] && right[i] != ground) s.parent[i] = static_cast<Index>(j);
      }),
      defect<in>("links_exchanged", "the first two links of a constraint, each with the other's K", [](Structure& s) {
        for (auto& e : s.link_constraints)
          if (e.links.size() > 1) std::swap(e.links[0].body, e.links[1].body);
      }),
      defect<in>("parent_as_link", "a constraint of a body and its parent, child and parent exchanged", [](Structure& s) {
        for (auto& e : s.link_constraints)
          for (auto& a : e.links)
            for (auto& b : e.links)
              if (&a < &b && (s.parent[static_cast<std::size_t>(a.body)] == b.body || s.parent[static_cast<std::size_t>(b.body)] == a.body))
                std::swap(a.body, b.body);
      }),
      defect<in>("unary_link_on_parent", "a constraint to the ground holds the parent of its body", [](Structure& s) {
        for (auto& e : s.link_constraints)
          if (const Index p = s.parent[static_cast<std::size_t>(e.links[0].body)]; e.links.size() == 1 && p != ground) e.links[0].body = p;
      }),
  };
}

std::vector<DefectRow> constraint_defects() {
  constexpr Place in = Place::numbers;
  return {
      defect<in>("last_row_forgotten", "K = 0 in the last row of the last link constraint",
                 [](auto n) { if (!n.p.K.empty()) n.p.K.back().setZero(); }),
      defect<in>("last_loop_forgotten", "K = 0 in the last constraint between several bodies", [](auto n) {
        const auto& all = n.s.link_constraints;
        const auto e = std::find_if(all.rbegin(), all.rend(), [](const auto& c) { return c.links.size() > 1; });
        if (e == all.rend()) return;
        for (const auto& link : e->links)
          for (Index r = 0; r < e->rows; ++r) n.p.K[static_cast<std::size_t>(link.first + r)].setZero();
      }),
      defect<in>("second_link_forgotten", "K = 0 on the second link", [](auto n) { n.rows_of_link(1, [](auto& k) { k.setZero(); }); }),
      defect<in>("third_link_forgotten", "K = 0 on the third link", [](auto n) { n.rows_of_link(2, [](auto& k) { k.setZero(); }); }),
      defect<in>("second_link_sign", "−K on the second link", [](auto n) { n.rows_of_link(1, [](auto& k) { k = -k; }); }),
      defect<in>("second_link_frame", "K of the second link about a point 1 m beside", [](auto n) {
        using T = scalar_of<decltype(n)>;
        n.rows_of_link(1, [](auto& k) { k.template head<3>() += cross_x<T>(k.template tail<3>()); });
      }),
      defect<in>("linear_part_first", "K of the second link with linear and angular part exchanged",
                 [](auto n) { n.rows_of_link(1, [](auto& k) { k.template head<3>().swap(k.template tail<3>()); }); }),
      defect<in>("angular_part_forgotten", "K without its angular part", [](auto n) {
        for (auto& k : n.p.K) k.template head<3>().setZero();
      }),
      defect<in>("rows_of_second_link_reversed", "the rows of K on the second link in reverse order", [](auto n) {
        for (const auto& e : n.s.link_constraints)
          if (e.links.size() > 1) std::reverse(n.p.K.begin() + e.links[1].first, n.p.K.begin() + e.links[1].first + e.rows);
      }),
      defect<in>("trees_not_coupled", "K = 0 on links that belong to another tree than the first link", [](auto n) {
        for (const auto& e : n.s.link_constraints)
          for (const auto& link : e.links)
            for (Index r = 0; root(n.s, link.body) != root(n.s, e.links[0].body) && r < e.rows; ++r)
              n.p.K[static_cast<std::size_t>(link.first + r)].setZero();
      }),
      defect<in>("rows_beyond_six", "K = 0 in the seventh row of a constraint and those after it", [](auto n) {
        for (const auto& e : n.s.link_constraints)
          for (const auto& link : e.links)
            for (Index r = 6; r < e.rows; ++r) n.p.K[static_cast<std::size_t>(link.first + r)].setZero();
      }, "needs a constraint of seven rows"),
      defect<in>("lone_row_sign", "−K on the second link of constraints of one row", [](auto n) {
        for (const auto& e : n.s.link_constraints)
          if (e.rows == 1 && e.links.size() > 1) n.p.K[static_cast<std::size_t>(e.links[1].first)] *= scalar_of<decltype(n)>(-1);
      }),
      defect<in>("joint_rows_sign", "−𝒦", [](auto n) { for (auto& k : n.p.joint_K) k = -k; }),
      defect<in>("joint_row_on_next_column", "𝒦 on the wrong column of a joint of several degrees of freedom",
                 [](auto n) { n.joint_rows([](auto k, Index dofs) { std::rotate(k, k + 1, k + dofs); }); }),
      defect<in>("last_joint_row_wins", "of two constraints on one joint, the last alone", [](auto n) {
        const auto& all = n.s.joint_constraints;
        for (std::size_t a = 0; a < all.size(); ++a)
          for (std::size_t b = a + 1; b < all.size(); ++b)
            if (all[a].body == all[b].body) std::fill_n(n.p.joint_K.begin() + all[a].first, all[a].rows * n.s.dofs(all[a].body), 0);
      }),
      defect<in>("nan_as_zero", "NaN in K read as 0", [](auto n) {
        for (auto& k : n.p.K)
          for (auto& x : k) if (!(x == x)) x = 0;
      }),
      defect<in>("second_update_ignored", "the numbers of the first update stay", [](auto n) {
        if (n.updates == 0) return;
        n.p.S = n.first.S;
        n.p.H = n.first.H;
        n.p.K = n.first.K;
        n.p.armature = n.first.armature;
        n.p.joint_K = n.first.joint_K;
      }),
      defect<in>("no_empty_size", "update without rows ends with lost_pivot",
                 [](auto n) { if (n.s.rows == 0) n.report.status = Status::lost_pivot; }),
      defect<in>("stale_K", "K of the first update stays", [](auto n) { if (n.updates > 0) n.p.K = n.first.K; }),
      defect<in>("stale_last_inertia", "H of the last body stays that of the first update",
                 [](auto n) { if (n.updates > 0 && !n.p.H.empty()) n.p.H.back() = n.first.H.back(); }),
  };
}

std::vector<DefectRow> body_defects() {
  constexpr Place in = Place::numbers;
  return {
      defect<in>("no_armature", "armature 0", [](auto n) { for (auto& a : n.p.armature) a = 0; }),
      defect<in>("armature_twice", "2 A", [](auto n) { for (auto& a : n.p.armature) a += a; }),
      defect<in>("armature_on_next_dof", "A on the next degree of freedom", [](auto n) {
        if (!n.p.armature.empty()) std::rotate(n.p.armature.begin(), n.p.armature.end() - 1, n.p.armature.end());
      }),
      defect<in>("armature_of_one_dof_joints", "A of joints of several degrees of freedom forgotten",
                 [](auto n) { n.joints([&](Index first, Index dofs) { if (dofs > 1) std::fill_n(n.p.armature.begin() + first, dofs, 0); }); }),
      defect<in>("last_body_massless", "H = 0 for the last body of several", [](auto n) { if (n.p.H.size() > 1) n.p.H.back().setZero(); }),
      defect<in>("leaf_forgotten", "H of the last body is not added to its ancestors' inertia, but for a tenth of it", [](auto n) {
        if (n.p.H.size() > 1) n.p.H.back() *= scalar_of<decltype(n)>(0.125);
      }),
      defect<in>("bodies_beyond_64", "H of body 64 and later read as that of body 63",
                 [](auto n) { for (std::size_t i = 64; i < n.p.H.size(); ++i) n.p.H[i] = n.p.H[63]; }, "needs 65 bodies"),
      defect<in>("inertia_transposed_offset", "m ĉ transposed: the centre of mass on the other side", [](auto n) {
        for (auto& h : n.p.H) {
          h.template topRightCorner<3, 3>() *= scalar_of<decltype(n)>(-1);
          h.template bottomLeftCorner<3, 3>() *= scalar_of<decltype(n)>(-1);
        }
      }),
      defect<in>("inertia_one_triangle", "H without its upper triangle: not symmetrised",
                 [](auto n) { for (auto& h : n.p.H) h.template topRightCorner<3, 3>().setZero(); }),
      defect<in>("inertia_diagonal", "products of inertia forgotten", [](auto n) {
        for (auto& h : n.p.H)
          for (Index r = 0; r < 3; ++r)
            for (Index c = 0; c < 3; ++c) if (r != c) h(r, c) = 0;
      }),
      defect<in>("massless_gets_1e-9_kg", "1e-9 kg in place of 0", [](auto n) {
        for (auto& h : n.p.H)
          if (h.isZero(scalar_of<decltype(n)>(0))) h.diagonal().setConstant(scalar_of<decltype(n)>(0x1p-30));
      }),
      defect<in>("joint_axis_frame", "S of the last joint about a point 1 m beside", [](auto n) {
        using T = scalar_of<decltype(n)>;
        if (!n.p.S.empty()) n.p.S.back().template tail<3>() += cross_x<T>(n.p.S.back().template head<3>());
      }),
      defect<in>("joint_columns_reversed", "S of joints of several degrees of freedom with its columns in reverse order",
                 [](auto n) { n.joints([&](Index first, Index dofs) { std::reverse(n.p.S.begin() + first, n.p.S.begin() + first + dofs); }); }),
      defect<in>("last_column_of_joint", "the last column of S of joints of several degrees of freedom twice as long", [](auto n) {
        using T = scalar_of<decltype(n)>;
        n.joints([&](Index first, Index dofs) { if (dofs > 1) n.p.S[static_cast<std::size_t>(first + dofs - 1)] *= T(2); });
      }),
  };
}

}  // namespace

std::vector<DefectRow> problem_defects() {
  std::vector<DefectRow> all = tree_defects();
  for (auto part : {constraint_defects, body_defects})
    for (DefectRow& d : part()) all.push_back(std::move(d));
  return all;
}

}  // namespace delassus::laws
