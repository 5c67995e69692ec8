// The path of scenes with several trees and with rows: every island is solved apart, by the path that it has alone.
//
//   islands   trees joined by rows that always hold and by the contacts of the step (islands.h)
//   each      its own problem, solvers and end of iteration: free, equations or cones
// What rests (Moment::resting) has no rows and is no island; its impulses are kept.
// Bits     of an island are those of a scene that holds nothing else.
// What is rejoined are changes of velocities and impulses, in the order of the whole. The factor of rows that always hold is there for
// who closes their drift, whatever path was taken.
// Cost     that of the paths, and a copy of the numbers where there are several. Allocates where islands change.
#pragma once

#include <functional>
#include <map>

#include "simulation/cone_path.h"
#include "simulation/islands.h"

namespace delassus::simulation {

template <class T> class IslandsPath final : public Path<T> {
 public:
  /// The path of a mechanism that holds together; `equations` (or null) of its rows that always hold, `rows` their numbers in the whole.
  using Make = std::function<std::shared_ptr<Path<T>>(const std::shared_ptr<const Structure>& structure, const Damping<double>& damping,
                                                      const std::shared_ptr<EquationsPath<T>>& equations, const std::vector<Index>& rows)>;
  using MakeEquations = std::function<std::shared_ptr<EquationsPath<T>>(const std::shared_ptr<const Structure>& structure, const Damping<double>& damping)>;

  /// `name`: that of the paths of islands with rows.
  IslandsPath(std::string_view name, std::shared_ptr<const Structure> structure, Damping<double> damping, Make make, const MakeEquations& make_equations);
  [[nodiscard]] std::string_view name() const override { return name_; }
  StepReport velocities(Moment<T>& now, VectorX<T>& change, VectorX<T>& impulses) override;
  void remember(const Moment<T>& now, State<T>& next) override;
  void problems(const typename Path<T>::Visit& visit) const override;
  [[nodiscard]] Index bytes() const override;

  /// Trees joined by rows that always hold.
  struct Loops {
    Part<T> part;
    std::shared_ptr<EquationsPath<T>> path;
  };
  [[nodiscard]] const std::vector<Loops>& loops() const { return loops_; }

 private:
  /// An island, as a scene of its own.
  struct Mover {
    Mover(Part<T> of, const Moment<T>& whole);
    Part<T> part;
    std::shared_ptr<EquationsPath<T>> equations;
    std::shared_ptr<Path<T>> path;
    std::vector<Loops*> loops;     // in it, where they are several or not all of it
    State<T> state;                // ν and impulses
    std::vector<RowSet<T>> rows;
    std::vector<Index> at;         // of each row set: its first row in the whole
    VectorX<T> force, change, impulses;
    Moment<T> now;
    bool used = false;
  };
  void group(const Moment<T>& now);
  void deal(Moment<T>& now);
  [[nodiscard]] Index tree_of(const Identity& of) const;
  [[nodiscard]] Part<T> part_of(const std::vector<Index>& trees) const;
  static void hand_over(Mover& m, const Moment<T>& now);
  Mover& mover_of(const std::vector<Index>& trees, const Moment<T>& now);
  StepReport move(Mover& m, Moment<T>& now, VectorX<T>& change, VectorX<T>& impulses);
  StepReport move_whole(Moment<T>& now, VectorX<T>& change, VectorX<T>& impulses);

  std::string_view name_;
  std::shared_ptr<const Structure> structure_;
  Damping<double> damping_;
  Make make_;
  Islands islands_;
  std::vector<Loops> loops_;
  std::vector<Index> loops_of_;  // per tree, −1: no rows
  std::map<std::vector<Index>, std::unique_ptr<Mover>> movers_;
  std::size_t moved_ = 0;        // how many of those moving were asked in the last step
  std::vector<Mover*> moving_;   // in the order of their first trees
  std::vector<Mover*> of_tree_;  // null: at rest
  bool whole_ = false;           // one island is all there is: no number is copied
  std::vector<Index> grouped_;   // islands of these
  std::vector<std::uint8_t> resting_, grouped_resting_;  // per tree: now, and of these
  std::vector<typename State<T>::Impulse> kept_;  // of what is at rest
};

}  // namespace delassus::simulation
