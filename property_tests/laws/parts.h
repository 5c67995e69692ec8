// A problem taken apart into bodies and constraints that a law may edit freely, and put together again.
#pragma once

#include "property_tests/laws/variants.h"

namespace delassus::laws {

template <class T> struct Parts {
  struct Body {
    Index parent;               ///< ground, or a body of this list (in any order)
    MatrixX<T> S;               ///< 6 × n
    std::vector<T> armature;    ///< n
    Matrix6<T> H;
  };
  struct Link {
    Index body;
    MatrixX<T> K;               ///< rows × 6
  };
  struct Constraint {
    std::vector<Index> from;    ///< row of the given problem that each row is; `added` for new ones
    std::vector<Link> links;    ///< empty for a joint constraint
    Index joint = ground;       ///< body of a joint constraint
    MatrixX<T> joint_K;         ///< rows × n
    std::vector<T> diagonal;    ///< of R⁻¹; zero inside blocks
    std::vector<typename Damping<T>::Block> blocks;  ///< `row` counted from the constraint's first

    [[nodiscard]] Index rows() const { return static_cast<Index>(from.size()); }
  };
  static constexpr Index added = -1;

  std::vector<Body> bodies;
  std::vector<Constraint> constraints;   ///< in order of rows

  [[nodiscard]] Body& body(Index i) { return bodies[static_cast<std::size_t>(i)]; }
  [[nodiscard]] Index count() const { return static_cast<Index>(bodies.size()); }
  /// Appends a massless body; returns its index.
  Index add_body(Index parent, MatrixX<T> S);
  /// Appends hard rows without links.
  Constraint& add_hard(Index rows);
  /// Adds K to the block of a body, which gets one when it has none; the ground takes nothing.
  void add_link(Constraint& c, Index body, const MatrixX<T>& K);
};

/// Another description, and where its rows come from: `from[r]` is a row of the given problem, or −1.
template <class T> struct Second {
  Variant<T> numbers;
  std::vector<Index> from;
};

/// The parts of a problem, bodies and constraints in its order.
template <class T> [[nodiscard]] Parts<T> apart(const Problem<T>& p, const Damping<T>& d);
/// The problem of these parts: constraints in their order, bodies sorted so that parents come first.
template <class T> [[nodiscard]] Second<T> together(const Parts<T>& parts);

}  // namespace delassus::laws
