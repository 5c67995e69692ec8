#include "bench/page/plot.h"

#include <stdlib.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <sstream>

#include "bench/text.h"

namespace delassus::bench {

namespace {

/// Colours that stay apart for colour-blind readers (Okabe and Ito); dashes and marks tell them apart in print.
struct Style {
  const char* colour;
  int dash, mark;
};
constexpr Style styles[] = {{"#0072B2", 1, 7}, {"#D55E00", 1, 5},  {"#009E73", 2, 9},  {"#CC79A7", 4, 13},
                            {"#E69F00", 5, 6}, {"#56B4E9", 2, 4},  {"#8C564B", 4, 8},  {"#7F7F7F", 3, 12},
                            {"#0072B2", 2, 3}, {"#D55E00", 3, 11}, {"#009E73", 4, 10}, {"#CC79A7", 1, 15},
                            {"#E69F00", 3, 1}, {"#56B4E9", 1, 2},  {"#8C564B", 2, 14}, {"#7F7F7F", 1, 7}};

const Style& style_of(const Series& one) { return styles[static_cast<std::size_t>(one.style) % std::size(styles)]; }

std::string points(const Series& one, std::size_t most) {
  std::string s;
  for (std::size_t k = 0; k < std::min(most, one.points.size()); ++k) s += format("%.9g %.9g\n", one.points[k].first, one.points[k].second);
  return s + "e\n";
}

std::string script(const std::string& x_axis, const std::string& y_axis, const std::vector<Series>& series,
                   Axes axes) {
  std::ostringstream s;
  s << "set terminal svg size 640,340 dynamic font 'sans-serif,13'\n"
       "set encoding utf8\n"
    << (axes == Axes::logarithmic ? "set logscale xy\nset format '10^{%T}'\n"
        : axes == Axes::profile   ? "set logscale x\nset yrange [0:1.02]\nset format x '%g'\n"
                                  : "set yrange [0:*]\n")
    << "set grid lw 0.6\nset border 3\nset tics nomirror\n"
       "set key outside right top reverse Left samplen 2.5 spacing 1.15\n"
    << "set xlabel '" << x_axis << "'\nset ylabel '" << y_axis << "'\nplot ";
  for (std::size_t i = 0; i < series.size(); ++i) {
    const Style& style = style_of(series[i]);
    s << (i ? ", " : "") << "'-' with linespoints lw 1.8 ps 0.55 lc rgb '" << style.colour << "' dt " << style.dash
      << " pt " << style.mark << " title '" << series[i].title << "' noenhanced";
  }
  s << '\n';
  for (const Series& one : series) s << points(one, one.points.size());
  return s.str();
}

/// Heights of labels in the unit of the plot's height: as wanted, but at least `apart` from each other and within it.
std::vector<double> spread(const std::vector<double>& wanted, double apart) {
  std::vector<std::size_t> order(wanted.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return wanted[a] < wanted[b]; });
  std::vector<double> at = wanted;
  double low = 0;
  for (const std::size_t i : order) low = (at[i] = std::max(at[i], low)) + apart;
  double high = 0.98;
  for (auto i = order.rbegin(); i != order.rend(); ++i) high = (at[*i] = std::min(at[*i], high)) - apart;
  return at;
}

struct Range { double low, high; };  // whole decades, a tenth of one more or less
Range decades(const std::vector<Series>& series, double std::pair<double, double>::*coordinate) {
  Range r{HUGE_VAL, 0};
  for (const Series& one : series)
    for (const auto& p : one.points) r = {std::min(r.low, p.*coordinate), std::max(r.high, p.*coordinate)};
  return {std::pow(10, std::floor(std::log10(r.low) + 0.1)), std::pow(10, std::ceil(std::log10(r.high) - 0.1))};
}

std::string labelled_script(const std::string& x_axis, const std::string& y_axis, const std::vector<Series>& series) {
  const Range x = decades(series, &std::pair<double, double>::first);
  Range y = decades(series, &std::pair<double, double>::second);
  y = {y.low / 1.3, y.high * 1.3};  // so that no line lies on the axis
  std::vector<std::pair<double, double>> ends;  // the rightmost point of each
  std::vector<double> wanted;
  for (const Series& one : series) {
    ends.push_back(*std::max_element(one.points.begin(), one.points.end()));
    wanted.push_back(std::log(ends.back().second / y.low) / std::log(y.high / y.low));
  }
  const std::vector<double> at = spread(wanted, 0.055);
  std::size_t longest = 22;  // characters that fit beside a plot of 520
  for (const Series& one : series) longest = std::max(longest, one.title.size());
  const double wide = 520 + 7.5 * static_cast<double>(longest - 22), narrow = 520 / wide;
  std::ostringstream s;
  s << format("set terminal svg size %.0f,430", wide) << " dynamic font 'sans-serif,14'\nset encoding utf8\nset logscale xy\n"
    << format("set rmargin at screen %g\n", 0.68 * narrow) << "set bmargin at screen 0.155\nset tmargin at screen 0.98\n"
       "set grid lw 0.6\nset border 3\nset tics nomirror\nset format '10^{%T}'\nunset key\nset clip two\n"
    << format("set lmargin at screen %g\n", (y.low < 1e-9 ? 0.17 : 0.135) * narrow)  // 10⁻¹⁶ is wider than 10³
    << format("set xrange [%g:%g]\nset yrange [%g:%g]\n", x.low / 3, x.high * 3, y.low, y.high)
    << format("set xtics %g\nunset mxtics\n", x.high / x.low > 1e8 ? 1e4 : 10.0)
    << "set xlabel '" << x_axis << "'\nset ylabel '" << y_axis << "' offset 0.5,0\n";
  for (std::size_t i = 0; i < series.size(); ++i) {
    const Style& style = style_of(series[i]);
    s << format("set arrow from %.9g,%.9g to graph 1.03,%.4f nohead lw 0.6 dt 3 lc rgb '#888888'\n", ends[i].first,
                ends[i].second, at[i])
      << "set label '" << series[i].title
      << format("' at graph 1.05,%.4f left noenhanced point pt %d ps 0.7 lc rgb '%s' offset 0.9,-0.2\n", at[i], style.mark,
                style.colour);
  }
  s << "plot ";
  for (std::size_t i = 0; i < series.size(); ++i) {
    const Style& style = style_of(series[i]);
    s << (i ? ", " : "") << "'-' with linespoints lw 1.8 ps 0.7 lc rgb '" << style.colour << "' dt " << style.dash << " pt " << style.mark
      << " notitle";
    if (series[i].ringed) s << ", '-' with points pt 6 ps 1.5 lw 1.2 lc rgb '" << style.colour << "' notitle";
  }
  s << '\n';
  for (const Series& one : series) s << points(one, one.points.size()) << (one.ringed ? points(one, 1) : "");
  return s.str();
}

/// What gnuplot prints for a script; empty when it cannot be run or fails.
std::string run_gnuplot(const std::string& text) {
  std::string path = (std::filesystem::temp_directory_path() / "delassus-plot-XXXXXX").string();
  const int file = mkstemp(path.data());
  if (file < 0) return "";
  close(file);
  std::ofstream(path) << text;
  std::string out;
  if (std::FILE* pipe = popen(("gnuplot '" + path + "' 2>/dev/null").c_str(), "r")) {
    char buffer[4096];
    for (std::size_t n; (n = std::fread(buffer, 1, sizeof buffer, pipe)) > 0;) out.append(buffer, n);
    if (pclose(pipe) != 0) out.clear();
  }
  std::remove(path.c_str());
  return out;
}

void replace_all(std::string& s, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = s.find(from, at)) != std::string::npos; at += to.size()) s.replace(at, from.size(), to);
}

void cut(std::string& s, const std::string& begin, const std::string& end) {
  const std::size_t a = s.find(begin);
  const std::size_t b = a == std::string::npos ? a : s.find(end, a + begin.size());
  if (b != std::string::npos) s.erase(a, b + end.size() - a);
}

/// What gnuplot made of a script, fit for a page.
std::string page_svg(const std::string& id, const std::string& label, const std::string& text) {
  std::string svg = run_gnuplot(text);
  const std::size_t begin = svg.find("<svg");
  if (begin == std::string::npos) return "";
  svg.erase(0, begin);
  cut(svg, "<title>", "</title>");
  cut(svg, "<desc>", "</desc>");
  while (svg.find("<filter") != std::string::npos) cut(svg, "<filter", "</filter>");
  cut(svg, "xmlns:xlink=\"", "\"");
  replace_all(svg, "xlink:href", "href");
  for (const char* name : {"gpPt", "gpDot", "gnuplot_"}) replace_all(svg, name, id + "-" + name);  // ids unique per page
  replace_all(svg, "color=\"black\"", "");
  replace_all(svg, "fill=\"black\"", "fill=\"currentColor\"");
  replace_all(svg, "stroke='black'", "stroke='currentColor'");
  svg.insert(4, " class=\"plot\" role=\"img\" aria-label=\"" + escape(label) + "\"");
  return svg;
}

}  // namespace

std::string plot(const std::string& id, const std::string& label, const std::string& x_axis, const std::string& y_axis,
                 const std::vector<Series>& series, Axes axes) {
  return series.empty() ? "" : page_svg(id, label, script(x_axis, y_axis, series, axes));
}

std::string labelled_plot(const std::string& id, const std::string& label, const std::string& x_axis, const std::string& y_axis,
                          const std::vector<Series>& series) {
  std::vector<Series> drawn;
  for (const Series& one : series)
    if (!one.points.empty()) drawn.push_back(one);
  return drawn.empty() ? "" : page_svg(id, label, labelled_script(x_axis, y_axis, drawn));
}

std::string standalone(std::string svg) {
  if (!svg.empty()) svg.insert(4, " style=\"background:#fff;color:#000\"");
  return svg;
}

}  // namespace delassus::bench
