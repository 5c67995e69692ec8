// Joints of an SDF file: what moves, what couples, what closes a loop.
#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

#include "algorithms/errors/message.h"
#include "models/contacts.h"
#include "models/formats/sdf_builder.h"

namespace delassus {
namespace {

using V3 = Vector3<double>;
using Kind = Constraint::Kind;
using Type = SdfDocument::Type;

}  // namespace

Joint SdfBuilder::joint_of(const JointRow& row) {
  Joint out;
  out.name = options_.robot + "/" + row.name;
  switch (row.type) {
    case Type::ball: out.type = JointType::spherical; break;
    case Type::prismatic: out.type = JointType::prismatic; break;
    case Type::universal:
    case Type::revolute2: out.type = JointType::universal; break;
    case Type::screw: out.type = JointType::cylindrical; break;
    default: out.type = JointType::revolute;
  }
  if (!row.axes.empty() && row.type != Type::ball) out.axis = row.axes[0].direction;
  if (out.type == JointType::universal) {
    out.axis2 = row.axes[1].direction;
    if (out.axis.cross(out.axis2).norm() < 1e-12) fail(row.element, "its two axes, (" + numbers_text(out.axis) + ") and (" + numbers_text(out.axis2) + "), are parallel", "two independent axes; turn <axis2>, or take a revolute joint");
  }
  const std::size_t n = static_cast<std::size_t>(dof_count(out.type));
  const auto given = options_.armature.find(row.name);
  out.armature.assign(n, given != options_.armature.end() ? given->second : std::max(0.0, options_.armature_of_all));
  if (row.axes.empty() || row.type == Type::ball) return out;
  for (std::size_t k = 0; k < n; ++k) {
    const bool moves_freely = row.type == Type::screw && k == 1;
    const SdfDocument::Axis& a = row.axes[std::min(k, row.axes.size() - 1)];
    out.damping.push_back(moves_freely ? 0 : a.damping);
    out.friction.push_back(moves_freely ? 0 : a.friction);
  }
  if (row.type != Type::screw && row.type != Type::continuous) set_limits(row, n, out);
  return out;
}

void SdfBuilder::set_limits(const JointRow& row, std::size_t n, Joint& out) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  auto any = [&](bool SdfDocument::Axis::*given) { return std::any_of(row.axes.begin(), row.axes.begin() + static_cast<long>(n), [&](const auto& a) { return a.*given; }); };
  if (any(&SdfDocument::Axis::range_given)) {
    for (std::size_t k = 0; k < n; ++k) {
      const SdfDocument::Axis& a = row.axes[k];
      const bool reversed = a.lower > a.upper;
      if (reversed)
        findings_.warn("reversed limits", options_.file, row.element, "lower " + number_text(a.lower) + " is above upper " + number_text(a.upper) + "; they are left out", "lower <= upper [rad or m]");
      out.lower.push_back(reversed || a.lower <= -1e16 ? -infinity : a.lower);
      out.upper.push_back(reversed || a.upper >= 1e16 ? infinity : a.upper);
    }
  }
  if (any(&SdfDocument::Axis::effort_given))
    for (std::size_t k = 0; k < n; ++k) out.effort.push_back(row.axes[k].effort_given ? row.axes[k].effort : infinity);
  if (any(&SdfDocument::Axis::velocity_given))
    for (std::size_t k = 0; k < n; ++k) out.velocity.push_back(row.axes[k].velocity_given ? row.axes[k].velocity : infinity);
}

/// Turns about the axis against travel along it: travel = −angle / thread_pitch.
void SdfBuilder::add_screw(const JointRow& row) {
  if (row.thread_pitch == 0) fail(row.element, "thread_pitch is 0", "thread_pitch [rad/m] other than 0; give it, or take a revolute joint");
  findings_.warn("screw joint", options_.file, row.element, "thread_pitch " + number_text(row.thread_pitch) + " is taken as in Gazebo: travel = -angle / thread_pitch", "compare with what the file means");
  Constraint c;
  c.name = options_.robot + "/" + row.name + " screw";
  c.kind = Kind::coupling;
  const Index body = out_.joints.at(row.name);
  c.terms = {{body, 1, 1, {}}, {body, 0, 1 / row.thread_pitch, {}}};
  model_.constraints.push_back(std::move(c));
}

/// The body whose single revolute joint turns `link` against `reference`, and the sense about `axis` (world).
std::pair<Index, double> SdfBuilder::turn_of(const JointRow& gear, const std::string& link, const V3& axis) const {
  for (std::size_t j = 0; j < file_.joints.size(); ++j) {
    const JointRow& row = file_.joints[j];
    const bool forward = row.parent == gear.reference && row.child == link, backward = row.child == gear.reference && row.parent == link;
    if (!in_tree_[j] || (!forward && !backward) || (row.type != Type::revolute && row.type != Type::continuous)) continue;
    const double along = (row.pose.rotation * row.axes[0].direction).dot(axis);
    if (std::abs(along) < 0.5) continue;
    return {out_.joints.at(row.name), (forward ? 1 : -1) * (along > 0 ? 1 : -1)};
  }
  fail(gear.element, "link " + in_quotes(link) + " has no revolute joint of that axis to the reference body " + in_quotes(gear.reference), "one for the parent and one for the child; check <gearbox_reference_body> and the axes");
}

/// angle₂ = −ratio · angle₁, of the child and of the parent against the reference body.
void SdfBuilder::add_gearbox(const JointRow& row) {
  const auto [b1, s1] = turn_of(row, row.parent, row.pose.rotation * row.axes[0].direction);
  const auto [b2, s2] = turn_of(row, row.child, row.pose.rotation * row.axes[1].direction);
  if (b1 == b2) fail(row.element, "joins a joint to itself", "two joints; name two links that turn against the reference body");
  if (row.ratio == 0) fail(row.element, "gearbox_ratio is 0: it would not drive the child", "a ratio other than 0; give it, or fix the child's joint");
  Constraint c;
  c.name = options_.robot + "/" + row.name + " gearbox";
  c.kind = Kind::coupling;
  c.terms = {{b2, 0, s2, {}}, {b1, 0, row.ratio * s1, {}}};
  model_.constraints.push_back(std::move(c));
  out_.mimics.push_back({b2, b1, -row.ratio * s1 * s2, 0});
}

/// A frame at the joint, on one of its links.
Frame SdfBuilder::frame_on(const std::string& link, const JointRow& row, const Matrix3<double>& axes) const {
  const Pose<double> at = row.pose * Pose<double>{axes, V3::Zero()};
  if (link == "world") return {ground, options_.pose * at};
  const Frame& frame = out_.links.at(link);
  return {frame.body, frame.placement * file_.links[index_.at(link)].pose.inverse() * at};
}

void SdfBuilder::close_loop(const JointRow& row) {
  Constraint c;
  const V3 axis = row.axes.empty() ? V3(0, 0, 1) : row.axes[0].direction;
  Matrix3<double> a = frame_about(axis), b = a;
  switch (row.type) {
    case Type::revolute:
    case Type::continuous: c.kind = Kind::hinge; break;
    case Type::ball: c.kind = Kind::point; break;
    case Type::fixed: c.kind = Kind::weld; break;
    case Type::prismatic: c.kind = Kind::prismatic; break;
    case Type::universal:
    case Type::revolute2:
      if (std::abs(axis.dot(row.axes[1].direction)) > 1e-12) fail(row.element, "closes a loop and its axes are not perpendicular: their cosine is " + number_text(axis.dot(row.axes[1].direction)), "perpendicular axes; turn one, or put another joint of the loop last in the file");
      c.kind = Kind::universal;
      a = frame_about(row.axes[1].direction);
      b << axis, frame_about(axis).leftCols<2>();
      break;
    case Type::screw:
    case Type::gearbox: fail(row.element, "a screw cannot close a loop", "other joints; put another joint of the loop last in the file");
  }
  c.name = options_.robot + "/" + row.name;
  c.a = frame_on(row.child, row, a), c.b = frame_on(row.parent, row, b);
  c.loop = true;
  if (c.a.body == c.b.body) return tally_.add("joints between links of one body, without effect", row.name);
  tally_.add("joints that close a loop, as constraints", row.name);
  model_.constraints.push_back(std::move(c));
}

}  // namespace delassus
