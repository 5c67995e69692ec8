// <equality> as constraints: connect, weld, joint, and tendon where all tendons are fixed ones.
#include <cmath>

#include "algorithms/errors/message.h"
#include "algorithms/kit/index.h"
#include "models/formats/mjcf_reader.h"

namespace delassus {
namespace {

/// c0 + c1 x + … + c4 x⁴ and its slope.
struct Polynomial {
  double value = 0, slope = 0;
  bool straight = true;

  Polynomial(const double* c, double x) {
    for (int k = 4; k >= 0; --k) slope = slope * x + value, value = value * x + c[k];
    for (int k = 2; k <= 4; ++k) straight = straight && c[k] == 0;
  }
};

}  // namespace

std::string MjcfReader::equality_name(int e) const {
  static constexpr const char* kinds[] = {"connect", "weld", "joint", "tendon", "distance"};
  const std::string given = name(mjOBJ_EQUALITY, e), kind = kinds[m_.eq_type[e]];
  return given.empty() ? kind + " equality " + std::to_string(e) : given;
}

void MjcfReader::leave_out(const std::string& equality, const std::string& why) {
  findings_.note(options_.robot + ": equality " + in_quotes(equality) + " is left out: " + why);
}

void MjcfReader::add_loop(Constraint c, const std::string& equality) {
  c.name = options_.robot + "/" + equality;
  c.loop = true;
  if (c.a.body == c.b.body) return leave_out(equality, c.a.body == ground ? "both ends are fixed to the world" : "both ends are one rigid body");
  model_.constraints.push_back(std::move(c));
}

/// The frames of two sites, or their origins, coincide.
void MjcfReader::add_sites(const SiteEquality& s) {
  const std::string equality = name_of(s);
  if (!s.active) return leave_out(equality, "it is not active");
  Constraint c;
  c.kind = s.weld ? Constraint::Kind::weld : Constraint::Kind::point;
  for (const auto& [site, frame] : {std::pair{&s.site1, &c.a}, {&s.site2, &c.b}}) {
    const int k = mj_name2id(&m_, mjOBJ_SITE, site->c_str());
    if (k < 0) fail("equality " + in_quotes(equality) + in_line(lines_.line(s.weld ? "weld" : "connect", s.name)), "site " + in_quotes(*site) + " does not exist", "a site of this file; correct the name");
    *frame = link_frame(m_.site_bodyid[k], mujoco_pose(m_.site_pos + 3 * k, m_.site_quat + 4 * k));
  }
  add_loop(std::move(c), equality);
}

/// Weld: eq_data has the anchors in body 2 and in body 1, then the orientation of body 2 in body 1. Connect: the anchors in
/// body 1 and in body 2.
void MjcfReader::add_pair(int e) {
  const double* data = m_.eq_data + e * mjNEQDATA;
  const bool weld = m_.eq_type[e] == mjEQ_WELD;
  static constexpr double none[4] = {1, 0, 0, 0};
  Constraint c;
  c.kind = weld ? Constraint::Kind::weld : Constraint::Kind::point;
  c.a = link_frame(m_.eq_obj1id[e], mujoco_pose(weld ? data + 3 : data, weld ? data + 6 : none));
  c.b = link_frame(m_.eq_obj2id[e], mujoco_pose(weld ? data : data + 3, none));
  add_loop(std::move(c), equality_name(e));
}

/// q1 − ref1 = polynomial of q2 − ref2, or a constant. In our q, which is qpos: q1 = slope q2 + offset.
void MjcfReader::add_joint_equality(int e) {
  const int j1 = m_.eq_obj1id[e], j2 = m_.eq_obj2id[e];
  const double* data = m_.eq_data + e * mjNEQDATA;
  Constraint c;
  c.name = options_.robot + "/" + equality_name(e);
  const Index a = body_of_[z(j1)];
  const int q1 = m_.jnt_qposadr[j1];
  if (j2 < 0) {
    c.kind = Constraint::Kind::joint_lock;
    c.a.body = a;
    const double held = m_.qpos0[q1] + data[0];
    start(a, {held});
    model_.constraints.push_back(std::move(c));
    return;
  }
  const Index b = body_of_[z(j2)];
  if (a == b) return leave_out(equality_name(e), "a joint is coupled with itself");
  const int q2 = m_.jnt_qposadr[j2];
  const Polynomial p(data, qpos_[z(q2)] - m_.qpos0[q2]);
  if (!p.straight)
    findings_.warn("curved coupling", options_.file, "equality " + in_quotes(equality_name(e)),
                   "joint " + in_quotes(joint_name(j1)) + " follows a polynomial of joint " + in_quotes(joint_name(j2)) + "; taken is its tangent at " + number_text(qpos_[z(q2)]) + ", slope " + number_text(p.slope),
                   "right at this pose only: choose it with keyframe, or give the row as a coupling of the scene");
  const double offset = m_.qpos0[q1] + p.value - p.slope * qpos_[z(q2)];
  c.kind = Constraint::Kind::coupling;
  c.terms = {{a, 0, 1, {}}, {b, 0, -p.slope, {}}};
  out_.mimics.push_back({a, b, p.slope, offset});
  model_.constraints.push_back(std::move(c));
}

/// Adds factor · (rate of a fixed tendon) to the terms, and gives its length less that at qpos0. False: it is spatial, or
/// over joints with several coordinates.
bool MjcfReader::add_tendon(int t, double factor, std::vector<Constraint::Term>& terms, double& length) const {
  length = 0;
  for (int k = m_.tendon_adr[t]; k < m_.tendon_adr[t] + m_.tendon_num[t]; ++k) {
    if (m_.wrap_type[k] != mjWRAP_JOINT) return false;
    const int j = m_.wrap_objid[k], q = m_.jnt_qposadr[j];
    if (m_.jnt_type[j] != mjJNT_HINGE && m_.jnt_type[j] != mjJNT_SLIDE) return false;
    const Index body = body_of_[z(j)];
    length += m_.wrap_prm[k] * (qpos_[z(q)] - m_.qpos0[q]);
    bool there = false;
    for (Constraint::Term& term : terms)
      if (term.body == body) term.coefficient += factor * m_.wrap_prm[k], there = true;
    if (!there) terms.push_back({body, 0, factor * m_.wrap_prm[k], {}});
  }
  return true;
}

void MjcfReader::add_tendon_equality(int e) {
  const int t1 = m_.eq_obj1id[e], t2 = m_.eq_obj2id[e];
  const double* data = m_.eq_data + e * mjNEQDATA;
  const std::string element = "equality " + in_quotes(equality_name(e));
  Constraint c;
  c.name = options_.robot + "/" + equality_name(e);
  c.kind = Constraint::Kind::coupling;
  double length1 = 0, length2 = 0;
  std::vector<Constraint::Term> unused;
  bool fixed = add_tendon(t1, 1, c.terms, length1);
  if (fixed && t2 >= 0) fixed = add_tendon(t2, 0, unused, length2);
  if (!fixed) {
    findings_.warn("spatial tendon", options_.file, element, "holds the length of a tendon through space, or over a ball joint, which has no row here; it is left out", "fixed tendons over hinges and slides, or constraints of the scene");
    return;
  }
  const Polynomial p(data, length2);
  double again = 0;
  if (t2 >= 0) static_cast<void>(add_tendon(t2, -p.slope, c.terms, again));
  if (t2 >= 0 && !p.straight)
    findings_.warn("curved coupling", options_.file, element, "couples tendons by a polynomial; taken is its tangent at the start pose, slope " + number_text(p.slope), "right at this pose only");
  const double open = length1 - (t2 >= 0 ? p.value : data[0]);
  if (std::fabs(open) > 1e-9)
    findings_.warn("open coupling", options_.file, element, "is open by " + number_text(open) + " at the start pose", "a pose that satisfies it");
  model_.constraints.push_back(std::move(c));
}

void MjcfReader::add_equalities() {
  bool any = false;
  if (m_.neq > 0 && (m_.opt.disableflags & mjDSBL_EQUALITY) != 0)
    findings_.warn("equalities switched off", options_.file, "option", "<flag equality=\"disable\"> switches all equalities off", "they are left out; remove the flag");
  for (int e = 0; e < m_.neq; ++e) {
    if (m_.opt.disableflags & mjDSBL_EQUALITY) break;
    if (!m_.eq_active[e]) {
      leave_out(equality_name(e), "it is not active");
      continue;
    }
    any = true;
    switch (m_.eq_type[e]) {
      case mjEQ_CONNECT:
      case mjEQ_WELD: add_pair(e); break;
      case mjEQ_JOINT: add_joint_equality(e); break;
      case mjEQ_TENDON: add_tendon_equality(e); break;
      default: findings_.warn("equality without rows", options_.file, "equality " + in_quotes(equality_name(e)), "an equality of this type is left out", "connect, weld, joint, tendon");
    }
  }
  for (const SiteEquality& pair : file_.site_equalities) add_sites(pair), any = true;
  if (any) findings_.note(options_.robot + ": equalities are hard rows; MuJoCo's solref and solimp are left to `damping` of the scene");
}

}  // namespace delassus
