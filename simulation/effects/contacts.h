// Contacts: which points touch, their rows, friction and restitution. Four rows of the table, each a term.
//
//   detection     points from shapes (models/contacts.h), at every configuration, as far ahead as bodies may come in a step
//   contacts      a row along the normal of each: u_n ≥ −φ/h where a gap φ is open, u_n ≥ min(β |φ|/h, 1 m/s) where it is not
//   friction      two tangents more, where the coefficient is above 0: the Coulomb cone
//   restitution   u_n⁺ ≥ −e u_n⁻ where a contact comes faster than 0.01 m/s and closes within the step
// Points of a list stay where they are on their body; the plane they touch stays on the other one.
// Cost     that of the detection, O(N log N + pairs); a contact 100 operations. Energy: contacts conserve (but what β gives back:
//          at most m (β φ/h)²/2 each), friction and restitution dissipate.
// Source   D. Stewart, J. Trinkle 1996 (the gap in the step); restitution: J. Moreau 1988.
#pragma once

#include "models/scene.h"
#include "simulation/terms.h"

namespace delassus::simulation {

inline constexpr double bounce_speed = 0.01;  ///< slower contacts do not bounce [m/s]

/// Contacts given as a list, of the scene's constraints.
[[nodiscard]] bool has_listed_contacts(const Scene& scene);

template <class T> class Detection final : public Effect, public DetectionTerm<T> {
 public:
  explicit Detection(const Scene& scene);
  void detect(Moment<T>& now) override;
  [[nodiscard]] Index bytes() const override { return static_cast<Index>(sizeof(*this) + speeds_.size() * sizeof(Vector6<double>) + reach_.size() * sizeof(double)); }

 private:
  void look_ahead(Moment<T>& now, const Poses<double>& at);
  ContactSearch search_;
  double friction_, ground_friction_, R_inverse_;
  std::vector<SceneMotion::Between> between_;
  std::vector<double> reach_;            // per body: of its shapes from its origin
  std::vector<Vector6<double>> speeds_;
  std::vector<std::string> notes_;
};

template <class T> class Contacts final : public Effect, public DetectionTerm<T>, public RowsTerm<T> {
 public:
  explicit Contacts(const Scene& scene);
  void detect(Moment<T>& now) override;    // those of a list
  void add_rows(Moment<T>& now) override;  // of all that touch
  [[nodiscard]] Index bytes() const override { return static_cast<Index>(sizeof(*this) + listed_.size() * sizeof(Listed)); }

 private:
  struct Listed {
    Index body, other;
    Vector3<double> point;       // in the body's frame
    Vector3<double> foot;        // a point of the plane, in the other's frame (in the world)
    Vector3<double> normal;      // in the other's frame
    double friction, R_inverse;
  };
  std::vector<Listed> listed_;
};

template <class T> class ContactFriction final : public Effect, public RowsTerm<T> {
 public:
  void add_rows(Moment<T>& now) override;
  [[nodiscard]] Index bytes() const override { return static_cast<Index>(sizeof(*this)); }
};

template <class T> class Restitution final : public Effect, public RowsTerm<T> {
 public:
  explicit Restitution(double e) : e_(e) {}
  void add_rows(Moment<T>& now) override;
  [[nodiscard]] Index bytes() const override { return static_cast<Index>(sizeof(*this)); }

 private:
  T e_;
};

}  // namespace delassus::simulation
