// One quantity against another, drawn by gnuplot as inline SVG.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace delassus::bench {

struct Series {
  std::string title;
  std::vector<std::pair<double, double>> points;  ///< (x, y); both positive on logarithmic axes
  int style = 0;                                  ///< colour, dashes and marks; equal numbers look equal in every plot
  bool ringed = false;    ///< the first point, by labelled_plot
};

enum class Axes : std::uint8_t { linear, logarithmic, profile };  ///< profile: x logarithmic, y a share from 0 to 1

/// An SVG element that fits into a page: no fixed size, text and axes in the page's own colour. Empty when gnuplot is
/// not installed or fails. `id` must be unique on the page; `label` is read out by screen readers.
[[nodiscard]] std::string plot(const std::string& id, const std::string& label, const std::string& x_axis,
                               const std::string& y_axis, const std::vector<Series>& series,
                               Axes axes = Axes::logarithmic);

/// For many series whose points lie close: both axes logarithmic, every series named at the right edge with a thin line
/// to its rightmost point. Otherwise as `plot`.
[[nodiscard]] std::string labelled_plot(const std::string& id, const std::string& label, const std::string& x_axis,
                                        const std::string& y_axis, const std::vector<Series>& series);

/// The same picture as a file of its own: black on white.
[[nodiscard]] std::string standalone(std::string svg);

}  // namespace delassus::bench
