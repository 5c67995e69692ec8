#include "bench/page/digits_picture.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "bench/page/drawing.h"
#include "bench/text.h"

namespace delassus::bench {

namespace {

/// A range of digits: its fill, darker as digits are lost, and the strokes of its hatching in a tile of 6 × 6.
struct Level {
  double from;
  const char *text, *colour, *hatch;
};
constexpr Level levels[] = {{14, "14–16", "#ffffff", ""},
                            {11, "11–14", "#cfe3f3", "M3,3h.01"},
                            {8, "8–11", "#8fbfe0", "M0,6L6,0"},
                            {4, "4–8", "#dc7f35", "M0,6L6,0M0,0L6,6"},
                            {0, "below 4", "#7a1c0c", ""}};
constexpr std::size_t most_labels = 40;

std::size_t level_of(double digits) {
  std::size_t k = 0;
  while (k + 1 < std::size(levels) && digits < levels[k].from) ++k;
  return k;
}

const char* const style = R"css(<style>
.picture{background:#fff;font-family:system-ui,-apple-system,"Segoe UI",Roboto,"DejaVu Sans",sans-serif}
.picture path{fill:none;stroke:#222;stroke-width:.9;stroke-linejoin:round}
.picture .ground{stroke:#ccc;stroke-width:.7}
.picture .link{stroke-width:1.6}
.picture .joint{fill:#fff}
.picture .contact{fill:#000;stroke:#fff;stroke-width:.5}
.picture .loop{fill:#fff;stroke-width:1.4}
.picture path.loop[d*="L"]{stroke-dasharray:4 2.5}
.picture .leader{stroke-width:.8}
.picture circle.disc{fill:#fff;stroke:#000;stroke-width:1.2}
.picture text.disc{font-size:12.5px;font-weight:700;text-anchor:middle}
.picture text.title{font-weight:700}
.picture text.panel{font-size:14px;font-weight:600}
.picture text.key{font-size:13px}
.picture text.scale{font-size:12px}
.picture pattern path{stroke:#1b3a57;stroke-width:1;stroke-linecap:round}
)css";

/// Style, patterns, title and legend, from 0 to header_height.
constexpr double header_height = 66, panel_title_height = 24;
std::string header(const std::string& title) {
  std::string rules = style, defs = "<defs>", keys;
  for (std::size_t k = 0; k < std::size(levels); ++k) {
    const Level& l = levels[k];
    rules += format(".picture path.d%zu:not(.link){fill:url(#digits%zu)}\n", k, k);
    defs += format("<pattern id=\"digits%zu\" width=\"6\" height=\"6\" patternUnits=\"userSpaceOnUse\"><rect width=\"6\" height=\"6\" "
                   "fill=\"%s\"/><path d=\"%s\"/></pattern>", k, l.colour, l.hatch);
    const double x = 14 + 91 * static_cast<double>(k);
    keys += format("<path class=\"d%zu\" d=\"M%.0f,35h26v17h-26z\"/><text class=\"key\" x=\"%.0f\" y=\"49\">%s</text>", k, x, x + 32, l.text);
  }
  return rules + "</style>" + defs + "</defs><rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>" +
         format("<text class=\"title\" x=\"14\" y=\"22\" font-size=\"%.1f\">", std::min(15.0, 720.0 / static_cast<double>(title.size()))) +
         escape(title) + "</text>" + keys;
}

std::string panel(const Scene& scene, const DigitsPanel& p) {
  Annotation a;
  for (const double d : p.digits)
    a.bodies.push_back({format("d%zu", level_of(d)), p.digits.size() <= most_labels ? format("%.0f", std::floor(d)) : ""});
  a.header = "<text class=\"panel\" x=\"14\" y=\"-8\">" + escape(p.title) + "</text>";
  a.header_height = panel_title_height;
  return draw(scene, a);
}

/// The height in the viewBox of an SVG of `draw`.
double height_of(const std::string& svg) {
  double left = 0, top = 0, width = 0, height = 0;
  std::sscanf(svg.c_str() + svg.find("viewBox=\""), "viewBox=\"%lf %lf %lf %lf", &left, &top, &width, &height);
  return height;
}

}  // namespace

std::string digits_picture(const Scene& scene, const std::vector<DigitsPanel>& panels, const std::string& title) {
  std::string body = header(title);
  double y = header_height;
  for (const DigitsPanel& p : panels) {
    std::string svg = panel(scene, p);
    const double height = height_of(svg);
    body += svg.insert(4, format(" y=\"%.0f\" width=\"%.0f\" height=\"%.0f\"", y, picture_width, height));
    y += height;
  }
  return format("<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"picture\" role=\"img\" viewBox=\"0 0 %.0f %.0f\" aria-label=\"", picture_width, y) +
         escape(title) + "\">" + body + "</svg>\n";
}

}  // namespace delassus::bench
