// One quantity against another, drawn by gnuplot as inline SVG.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace delassus::bench {

struct Series {
  std::string title;
  std::vector<std::pair<double, double>> points;  ///< (x, y); both positive on logarithmic axes
  int style = 0;                                  ///< colour, dashes and marks; equal numbers look equal in every plot
};

enum class Axes : bool { linear, logarithmic };

/// An SVG element that fits into a page: no fixed size, text and axes in the page's own colour. Empty when gnuplot is
/// not installed or fails. `id` must be unique on the page; `label` is read out by screen readers.
[[nodiscard]] std::string plot(const std::string& id, const std::string& label, const std::string& x_axis,
                               const std::string& y_axis, const std::vector<Series>& series,
                               Axes axes = Axes::logarithmic);

}  // namespace delassus::bench
