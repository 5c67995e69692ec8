#include "models/shapes/facets.h"

#include <stdexcept>
#include <string>

#include "algorithms/kit/index.h"

#ifdef DELASSUS_QHULL
#include <libqhull_r/qhull_ra.h>
#endif

namespace delassus {

#ifndef DELASSUS_QHULL

Surface surface(const std::vector<Vector3<double>>&, const std::vector<int>&, int) { throw std::logic_error("built without qhull"); }

#else

namespace {

/// qhull's memory, released whatever happens.
class Qhull {
 public:
  Qhull() : errors_(open_memstream(&text_, &size_)) { qh_zero(&qh_, errors_); }
  ~Qhull() {
    int current = 0, total = 0;
    qh_.NOerrexit = True;
    qh_freeqhull(&qh_, !qh_ALL);
    qh_memfreeshort(&qh_, &current, &total);
    std::fclose(errors_);
    std::free(text_);
  }
  Qhull(const Qhull&) = delete;
  Qhull& operator=(const Qhull&) = delete;

  /// The first line of qhull's complaint, or nothing.
  std::string run(int dimension, std::vector<double>& numbers) {
    char command[] = "qhull Qt";
    const int n = static_cast<int>(numbers.size()) / dimension;
    if (qh_new_qhull(&qh_, dimension, n, numbers.data(), False, command, nullptr, errors_) == 0) return "";
    std::fflush(errors_);
    const std::string said(text_, size_);
    return said.empty() ? "qhull failed" : said.substr(0, said.find('\n'));
  }

  qhT qh_{};

 private:
  char* text_ = nullptr;
  std::size_t size_ = 0;
  FILE* errors_;
};

}  // namespace

Surface surface(const std::vector<Vector3<double>>& x, const std::vector<int>& of, int dimension) {
  std::vector<double> numbers;
  for (const int i : of)
    for (int k = 0; k < dimension; ++k) numbers.push_back(x[z(i)][k]);
  Qhull q;
  if (const std::string said = q.run(dimension, numbers); !said.empty()) throw std::runtime_error(said);
  Surface out;
  out.dimension = dimension;
  qhT* const qh = &q.qh_;
  facetT* facet = nullptr;
  vertexT *vertex = nullptr, **vertexp = nullptr;
  FORALLfacets {
    Surface::Facet f{{0, 0, 0}, Vector3<double>::Zero(), facet->offset};
    for (int k = 0; k < dimension; ++k) f.normal[k] = facet->normal[k];
    std::size_t k = 0;
    FOREACHvertex_(facet->vertices) f.corner[k++] = of[z(qh_pointid(qh, vertex->point))];
    out.facets.push_back(f);
  }
  return out;
}

#endif

}  // namespace delassus
