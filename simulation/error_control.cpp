#include "simulation/error_control.h"

#include <algorithm>
#include <cmath>

#include "algorithms/kit/counted.h"

namespace delassus::simulation {

template <class T>
typename ErrorControl<T>::End ErrorControl<T>::operator()(const T& h, State<T>& state, const typename RungeKutta<T>::Acceleration& acceleration) {
  spent_ = {};
  const double interval = static_cast<double>(h);
  double done = 0, trial = state.trial > 0 ? std::min(state.trial, interval) : interval;
  method_.start(state);
  while (done < interval) {
    const double left = interval - done;
    const bool last = trial >= left;
    const double step = last ? left : std::min(trial, left / 2);  // no last step that is much shorter than the others
    const bool evaluated = method_.attempt(T(step), acceleration);
    spent_.iterations = method_.iterations(), spent_.left = static_cast<double>(method_.left());
    if (!method_.started()) return End::evaluation_failed;
    const double rate = evaluated ? static_cast<double>(method_.error()) / step : HUGE_VAL, off = rate / tolerance_;
    const double factor = off > 0 ? std::clamp(0.9 / std::pow(off, falls_), 0.2, 5.0) : off == 0 ? 5.0 : 0.2;
    if (off <= 1) {
      method_.accept(end_);
      done = last ? interval : done + step;
      ++spent_.taken;
      spent_.error = std::max(spent_.error, rate);
      trial = step < trial ? std::max(trial, step * factor) : step * factor;
    } else {
      ++spent_.rejected;
      trial = step * factor;
      if (trial < shortest * interval) return End::too_short;
    }
  }
  state.q = end_.q;
  state.nu = end_.nu;
  state.trial = std::min(trial, interval);
  return End::reached;
}

template class ErrorControl<double>;
template class ErrorControl<Counted>;

}  // namespace delassus::simulation
