#include "simulation/effects/spin_friction.h"

#include "algorithms/kit/counted.h"

namespace delassus::simulation {
namespace {

/// Adds rows with an arm to every contact whose coefficient, its own or the scene's, is above 0.
template <class T> void add(Moment<T>& now, const T& all, double Moment<T>::Touching::*of, Index directions, T RowSet<T>::*arm) {
  auto touching = now.touching.begin();  // a row set each, in this order
  for (RowSet<T>& s : *now.rows) {
    if (s.kind != RowSet<T>::Kind::contact) continue;
    const double own = (*touching++).*of;
    const T c = own >= 0 ? T(own) : all;
    if (!(c > T(0))) continue;
    if (!(s.coefficient > T(0))) s.coefficient = T(1);
    s.*arm = c / s.coefficient;
    s.directions += directions;
  }
}

}  // namespace

template <class T> void TorsionalFriction<T>::add_rows(Moment<T>& now) { add(now, c_, &Moment<T>::Touching::torsional, 1, &RowSet<T>::torsion); }
template <class T> void RollingFriction<T>::add_rows(Moment<T>& now) { add(now, c_, &Moment<T>::Touching::rolling, 2, &RowSet<T>::rolling); }

template class TorsionalFriction<double>;
template class TorsionalFriction<Counted>;
template class RollingFriction<double>;
template class RollingFriction<Counted>;

}  // namespace delassus::simulation
