#include "bench/plot.h"

#include <stdlib.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "bench/text.h"

namespace delassus::bench {

namespace {

/// Colours that stay apart for colour-blind readers (Okabe and Ito); dashes and marks tell them apart in print.
struct Style {
  const char* colour;
  int dash, mark;
};
constexpr Style styles[] = {{"#0072B2", 1, 7}, {"#D55E00", 1, 5},  {"#009E73", 2, 9}, {"#CC79A7", 4, 13},
                            {"#E69F00", 5, 6}, {"#56B4E9", 2, 4}, {"#8C564B", 4, 8}, {"#7F7F7F", 3, 12}};

std::string script(const std::string& x_axis, const std::string& y_axis, const std::vector<Series>& series,
                   Axes axes) {
  std::ostringstream s;
  s << "set terminal svg size 520,340 dynamic font 'sans-serif,13'\n"
       "set encoding utf8\n"
    << (axes == Axes::logarithmic ? "set logscale xy\nset format '10^{%T}'\n" : "set yrange [0:*]\n")
    << "set grid lw 0.6\nset border 3\nset tics nomirror\n"
       "set key at graph 0.02, graph 0.98 left top reverse Left samplen 3 spacing 1.2\n"
       "set offsets graph 0, graph 0, graph 0.05, graph 0\n"
    << "set xlabel '" << x_axis << "'\nset ylabel '" << y_axis << "'\nplot ";
  for (std::size_t i = 0; i < series.size(); ++i) {
    const Style& style = styles[static_cast<std::size_t>(series[i].style) % std::size(styles)];
    s << (i ? ", " : "") << "'-' with linespoints lw 1.8 ps 0.55 lc rgb '" << style.colour << "' dt " << style.dash
      << " pt " << style.mark << " title '" << series[i].title << "' noenhanced";
  }
  s << '\n';
  for (const Series& one : series) {
    for (const auto& [x, y] : one.points) s << format("%.9g %.9g\n", x, y);
    s << "e\n";
  }
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

}  // namespace

std::string plot(const std::string& id, const std::string& label, const std::string& x_axis, const std::string& y_axis,
                 const std::vector<Series>& series, Axes axes) {
  if (series.empty()) return "";
  std::string svg = run_gnuplot(script(x_axis, y_axis, series, axes));
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

}  // namespace delassus::bench
