#include "simulation/effects/spin_friction.h"

#include "algorithms/kit/counted.h"

namespace delassus::simulation {
namespace {

/// Adds rows with an arm to every contact.
template <class T> void add(std::vector<RowSet<T>>& rows, const T& c, Index directions, T RowSet<T>::*arm) {
  if (!(c > T(0))) return;  // forced on
  for (RowSet<T>& s : rows) {
    if (s.kind != RowSet<T>::Kind::contact) continue;
    if (!(s.coefficient > T(0))) s.coefficient = T(1);
    s.*arm = c / s.coefficient;
    s.directions += directions;
  }
}

}  // namespace

template <class T> void TorsionalFriction<T>::add_rows(Moment<T>& now) { add(*now.rows, c_, 1, &RowSet<T>::torsion); }
template <class T> void RollingFriction<T>::add_rows(Moment<T>& now) { add(*now.rows, c_, 2, &RowSet<T>::rolling); }

template class TorsionalFriction<double>;
template class TorsionalFriction<Counted>;
template class RollingFriction<double>;
template class RollingFriction<Counted>;

}  // namespace delassus::simulation
