#include "algorithms/kit/test_scalars.h"
#include "property_tests/campaigns/linkage_model.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace delassus::laws {
namespace {

using generators::Random;
using Q3 = Vector3<Quad>;

double uniform(Random& r, double low, double high) { return low + (high - low) * static_cast<double>(r.next() >> 11) * 0x1p-53; }

Matrix3<double> rotation(Random& r) {
  Eigen::Quaterniond q(uniform(r, -1, 1), uniform(r, -1, 1), uniform(r, -1, 1), uniform(r, -1, 1));
  return q.normalized().toRotationMatrix();
}

Vector3<double> rounded(const Q3& x) { return {static_cast<double>(x[0]), static_cast<double>(x[1]), static_cast<double>(x[2])}; }

/// Two unit vectors across x.
std::pair<Q3, Q3> across(const Q3& x) {
  const Q3 helper = abs(Quad(x[0])) < Quad(0.6) ? Q3(Quad(1), Quad(0), Quad(0)) : Q3(Quad(0), Quad(1), Quad(0));
  Q3 y = x.cross(helper);
  y /= sqrt(Quad(y.dot(y)));
  return {y, x.cross(y)};
}

/// Rows of a joint on the twists of all links about the world's origin, and (last) the joint's own rate.
std::vector<VectorX<Quad>> joint_rows(const Linkage& l, const LinkageJoint& j) {
  std::vector<VectorX<Quad>> rows;
  const auto add = [&](const Q3& angular, const Q3& linear) {  // angular · ω + linear · (v + ω × p)
    VectorX<Quad> row = VectorX<Quad>::Constant(6 * l.links, Quad(0));
    for (const auto& [link, sign] : {std::pair(j.b, 1), std::pair(j.a, -1)}) {
      if (link < 0) continue;
      row.segment(6 * link, 3) = (angular + j.point.cross(linear)) * Quad(sign);
      row.segment(6 * link + 3, 3) = linear * Quad(sign);
    }
    rows.push_back(row);
  };
  const Q3 none(Quad(0), Quad(0), Quad(0));
  const auto [y, z] = across(j.axis);
  for (const Q3& n : {y, z}) {
    add(n, none);
    add(none, n);
  }
  if (j.slides) add(j.axis, none), add(none, j.axis);
  else add(none, j.axis), add(j.axis, none);
  return rows;
}

MatrixX<Quad> inverse(MatrixX<Quad> B) {
  const Index n = B.rows();
  MatrixX<Quad> X = MatrixX<Quad>::Constant(n, n, Quad(0));
  for (Index k = 0; k < n; ++k) X(k, k) = Quad(1);
  for (Index k = 0; k < n; ++k) {
    Index p = k;
    for (Index r = k; r < n; ++r)
      if (abs(Quad(B(r, k))) > abs(Quad(B(p, k)))) p = r;
    B.row(k).swap(B.row(p));
    X.row(k).swap(X.row(p));
    const Quad d = B(k, k);
    B.row(k) /= d;
    X.row(k) /= d;
    for (Index r = 0; r < n; ++r) {
      if (r == k) continue;
      const Quad f = B(r, k);
      B.row(r) -= B.row(k) * f;
      X.row(r) -= X.row(k) * f;
    }
  }
  return X;
}

/// The rows that complete pivoting takes before what is left is below 1e-20.
std::vector<Index> independent(MatrixX<Quad> C) {
  std::vector<Index> order(static_cast<std::size_t>(C.rows())), taken;
  std::iota(order.begin(), order.end(), 0);
  for (Index k = 0; k < std::min(C.rows(), C.cols()); ++k) {
    Index p = k, q = k;
    for (Index r = k; r < C.rows(); ++r)
      for (Index c = k; c < C.cols(); ++c)
        if (abs(Quad(C(r, c))) > abs(Quad(C(p, q)))) p = r, q = c;
    if (!(abs(Quad(C(p, q))) > Quad(1e-20))) break;
    C.row(k).swap(C.row(p));
    C.col(k).swap(C.col(q));
    std::swap(order[static_cast<std::size_t>(k)], order[static_cast<std::size_t>(p)]);
    taken.push_back(order[static_cast<std::size_t>(k)]);
    for (Index r = k + 1; r < C.rows(); ++r) C.row(r) -= C.row(k) * Quad(C(r, k) / C(k, k));
  }
  return taken;
}

MatrixX<Quad> entrywise(MatrixX<Quad> x) {
  for (Index k = 0; k < x.size(); ++k) x.data()[k] = abs(x.data()[k]);
  return x;
}

}  // namespace

std::vector<LinkMass> random_masses(const Linkage& l, Random& r) {
  std::vector<LinkMass> all;
  for (Index i = 0; i < l.links; ++i) {
    LinkMass m{uniform(r, 0.5, 2), {uniform(r, -0.2, 0.2), uniform(r, -0.2, 0.2), uniform(r, -0.2, 0.2)}, {}};
    const Matrix3<double> axes = rotation(r);
    m.inertia = axes * Vector3<double>(uniform(r, 0.02, 0.03), uniform(r, 0.02, 0.03), uniform(r, 0.02, 0.03)).asDiagonal() * axes.transpose();
    m.inertia = (m.inertia + m.inertia.transpose().eval()) / 2;
    for (const LinkageJoint& j : l.joints)
      if (j.b == i) {
        m.com += rounded(j.point);
        break;
      }
    all.push_back(m);
  }
  return all;
}

Reduced reduced_inertia(const Linkage& l, const std::vector<LinkMass>& masses) {
  const Index n = 6 * l.links;
  std::vector<VectorX<Quad>> closed, rates;
  for (std::size_t k = 0; k < l.joints.size(); ++k) {
    std::vector<VectorX<Quad>> rows = joint_rows(l, l.joints[k]);
    if (static_cast<Index>(k) < l.mobility) rates.push_back(rows.back());
    closed.insert(closed.end(), rows.begin(), rows.end() - 1);
  }
  MatrixX<Quad> C(static_cast<Index>(closed.size()), n), B(n, n);
  for (Index r = 0; r < C.rows(); ++r) C.row(r) = closed[static_cast<std::size_t>(r)].transpose();
  const std::vector<Index> rows = independent(C);
  if (static_cast<Index>(rows.size()) != n - l.mobility) return {};
  for (Index r = 0; r < n - l.mobility; ++r) B.row(r) = C.row(rows[static_cast<std::size_t>(r)]);
  for (Index k = 0; k < l.mobility; ++k) B.row(n - l.mobility + k) = rates[static_cast<std::size_t>(k)].transpose();
  if (static_cast<Index>(independent(B).size()) != n) return {};
  const MatrixX<Quad> B_inverse = inverse(B), V = B_inverse.rightCols(l.mobility);  // twists per rate of a driver
  MatrixX<Quad> H = MatrixX<Quad>::Constant(n, n, Quad(0));
  for (Index i = 0; i < l.links; ++i) {
    const LinkMass& m = masses[static_cast<std::size_t>(i)];
    H.block(6 * i, 6 * i, 6, 6) = spatial_inertia<Quad>(Quad(m.mass), m.com.cast<Quad>(), m.inertia.cast<Quad>());
  }
  const MatrixX<Quad> v = entrywise(V), h = entrywise(H), change = entrywise(B_inverse) * MatrixX<Quad>(entrywise(B) * v);
  const MatrixX<Quad> moved = v.transpose() * MatrixX<Quad>(h * change);
  return {V.transpose() * MatrixX<Quad>(H * V), moved + MatrixX<Quad>(moved.transpose()) + MatrixX<Quad>(v.transpose() * MatrixX<Quad>(h * v))};
}

namespace {

template <class T> void shuffle(std::vector<T>& x, Random& r) {
  for (std::size_t k = x.size(); k > 1; --k) std::swap(x[k - 1], x[static_cast<std::size_t>(r.integer(0, static_cast<int>(k) - 1))]);
}

/// The joints of a spanning tree, parents first: drivers, then any joint with one link in the tree.
std::vector<Index> spanning_tree(const Linkage& l, Random& r) {
  std::vector<bool> in(static_cast<std::size_t>(l.links), false);
  const auto inside = [&](Index link) { return link < 0 || in[static_cast<std::size_t>(link)]; };
  std::vector<Index> tree, rest;
  const auto take = [&](Index k) {
    const LinkageJoint& j = l.joints[static_cast<std::size_t>(k)];
    in[static_cast<std::size_t>(inside(j.a) ? j.b : j.a)] = true;
    tree.push_back(k);
  };
  for (Index k = 0; k < l.mobility; ++k) take(k);
  for (Index k = l.mobility; k < static_cast<Index>(l.joints.size()); ++k) rest.push_back(k);
  while (static_cast<Index>(tree.size()) < l.links) {
    shuffle(rest, r);
    const auto next = std::find_if(rest.begin(), rest.end(), [&](Index k) {
      const LinkageJoint& j = l.joints[static_cast<std::size_t>(k)];
      return inside(j.a) != inside(j.b);
    });
    take(*next);
    rest.erase(next);
  }
  return tree;
}

}  // namespace

Turned turned_model(const Linkage& l, const std::vector<LinkMass>& masses, double length, double mass, Random& r) {
  Pose<double> world{rotation(r), Vector3<double>(uniform(r, -2, 2), uniform(r, -2, 2), uniform(r, -2, 2)) * length};
  const auto placed = [&](const Vector3<double>& x) { return Vector3<double>(world.rotation * (x * length) + world.translation); };
  Turned out;
  std::vector<Index> body(static_cast<std::size_t>(l.links), ground);
  std::vector<Pose<double>> at;  // of the bodies
  const auto frame_in = [&](Index link, const Pose<double>& x) {
    const Index b = link < 0 ? ground : body[static_cast<std::size_t>(link)];
    return Frame{b, b == ground ? x : at[static_cast<std::size_t>(b)].inverse() * x};
  };
  const std::vector<Index> tree = spanning_tree(l, r);
  for (const Index k : tree) {
    const LinkageJoint& j = l.joints[static_cast<std::size_t>(k)];
    const bool forward = j.a < 0 || body[static_cast<std::size_t>(j.a)] != ground;
    const Index child = forward ? j.b : j.a, parent = forward ? j.a : j.b;
    const LinkMass& m = masses[static_cast<std::size_t>(child)];
    const Pose<double> here{rotation(r), placed(rounded(j.point))};
    const Matrix3<double> to_body = here.rotation.transpose() * world.rotation;
    Body b;
    b.name = "link " + std::to_string(child);
    const Frame in_parent = frame_in(parent, here);
    b.parent = in_parent.body;
    b.joint.type = j.slides ? JointType::prismatic : JointType::revolute;
    b.joint.axis = (to_body * rounded(j.axis)).normalized();
    b.joint.placement = in_parent.placement;
    b.mass = m.mass * mass;
    b.com = here.inverse() * placed(m.com);
    const Matrix3<double> inertia = to_body * m.inertia * to_body.transpose() * (mass * length * length);
    b.inertia = (inertia + inertia.transpose()) / 2;
    body[static_cast<std::size_t>(child)] = out.model.add(b);
    at.push_back(here);
  }
  std::vector<std::pair<Constraint, Index>> rows;  // and the driver, −1: none
  for (Index k = 0; k < static_cast<Index>(l.joints.size()); ++k) {
    if (std::find(tree.begin(), tree.end(), k) != tree.end()) continue;
    const LinkageJoint& j = l.joints[static_cast<std::size_t>(k)];
    Matrix3<double> axes;
    const auto [y, z] = across(j.axis);
    axes << rounded(y), rounded(z), rounded(j.axis);
    const Pose<double> here{world.rotation * axes, placed(rounded(j.point))};
    Constraint c;
    c.name = "closure";
    c.kind = j.slides ? Constraint::Kind::prismatic : Constraint::Kind::hinge;
    const bool swap = j.b < 0 || (j.a >= 0 && r.coin());
    c.a = frame_in(swap ? j.a : j.b, here);
    c.b = frame_in(swap ? j.b : j.a, here);
    rows.emplace_back(c, -1);
  }
  for (Index k = 0; k < l.mobility; ++k) {
    Constraint c;
    c.name = "driver";
    c.kind = Constraint::Kind::joint_lock;
    c.a.body = body[static_cast<std::size_t>(l.joints[static_cast<std::size_t>(k)].b)];
    rows.emplace_back(c, k);
  }
  shuffle(rows, r);
  out.driver_rows.assign(static_cast<std::size_t>(l.mobility), 0);
  Index row = 0;
  for (const auto& [c, driver] : rows) {
    out.model.constraints.push_back(c);
    if (driver >= 0) out.driver_rows[static_cast<std::size_t>(driver)] = row;
    row += driver >= 0 ? 1 : 5;
  }
  return out;
}

}  // namespace delassus::laws
