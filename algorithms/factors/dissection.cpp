#include "algorithms/factors/dissection.h"

#include <algorithm>
#include <numeric>

#include "algorithms/kit/slab.h"

namespace delassus {
namespace {

class Dissection {
 public:
  explicit Dissection(const Graph& graph) : graph_(graph) {
    const auto count = static_cast<std::size_t>(graph.size());
    lists_.divide(Lists::Part{nodes_, count}, Lists::Part{part_, count}, Lists::Part{level_, count});
    std::iota(nodes_.begin(), nodes_.end(), 0);
    std::fill(level_.begin(), level_.end(), far);
    depth_.assign(count, 0);
    order_.reserve(count);
    first_.reserve(count + 1);
    open_.reserve(64);
  }

  std::vector<int> stages() {
    separate({0, graph_.size(), 1});
    int deepest = 0;
    while (!open_.empty()) {
      const Part part = open_.back();
      open_.pop_back();
      if (divide(part)) deepest = std::max(deepest, part.depth);
    }
    for (int& d : depth_)
      if (d > 0) d = deepest + 1 - d;
    return std::move(depth_);
  }

 private:
  static constexpr int far = -1, most_starts = 5;
  struct Part {
    int begin, end, depth;  // of nodes_
  };

  // Into what hangs together; what is small is left.
  void separate(Part p) {
    begin(p);
    for (int k = p.begin; k < p.end; ++k) {
      if (level_[nodes_[k]] != far) continue;
      const int from = static_cast<int>(order_.size());
      reach(nodes_[k]);
      if (const int to = static_cast<int>(order_.size()); to - from > undivided) open_.push_back({p.begin + from, p.begin + to, p.depth});
    }
    end(p);
  }

  // Of what hangs together. True: there is a separator.
  bool divide(Part p) {
    begin(p);
    reach(nodes_[p.begin]);
    for (int k = 0; k < most_starts; ++k) {
      const std::size_t levels = first_.size();
      const int start = far_end();
      forget();
      reach(start);
      if (first_.size() <= levels) break;
    }
    const int cut = best_level();
    if (cut == far) return end(p), false;
    const int level = first_[cut], beyond = first_[cut + 1];
    const auto touches = [&](int v) { return std::ranges::any_of(graph_.of(v), [&](int w) { return part_[w] == parts_ && level_[w] == cut + 1; }); };
    const int separator = static_cast<int>(std::partition(order_.begin() + level, order_.begin() + beyond, [&](int v) { return !touches(v); }) - order_.begin());
    for (int k = separator; k < beyond; ++k) depth_[order_[k]] = p.depth;
    end(p);
    separate({p.begin, p.begin + separator, p.depth + 1}), separate({p.begin + beyond, p.end, p.depth + 1});
    return true;
  }

  void begin(Part p) {
    ++parts_;
    for (int k = p.begin; k < p.end; ++k) part_[nodes_[k]] = parts_;
  }
  // In the order in which they were reached.
  void end(Part p) {
    std::copy(order_.begin(), order_.end(), nodes_.begin() + p.begin);
    forget();
  }

  // Appends to order_ the nodes of the part by their distance from one; first_: where each level begins, and the end.
  void reach(int from) {
    int k = static_cast<int>(order_.size());
    order_.push_back(from);
    first_.assign(1, k);
    level_[from] = 0;
    for (; k < static_cast<int>(order_.size()); ++k) {
      const int v = order_[k];
      if (level_[v] == static_cast<int>(first_.size())) first_.push_back(k);
      for (const int w : graph_.of(v))
        if (part_[w] == parts_ && level_[w] == far) level_[w] = level_[v] + 1, order_.push_back(w);
    }
    first_.push_back(static_cast<int>(order_.size()));
  }
  void forget() {
    for (const int v : order_) level_[v] = far;
    order_.clear();
  }

  // Of the nodes farthest away the one with the fewest neighbours.
  [[nodiscard]] int far_end() const {
    const auto degree = [&](int v) { return std::ranges::count_if(graph_.of(v), [&](int w) { return part_[w] == parts_; }); };
    return *std::min_element(order_.begin() + first_[first_.size() - 2], order_.end(), [&](int v, int w) { return degree(v) < degree(w); });
  }

  // `far`: too few levels.
  [[nodiscard]] int best_level() const {
    const double all = static_cast<double>(order_.size());
    double least = 0;
    int best = far;
    for (int k = 1; k + 2 < static_cast<int>(first_.size()); ++k) {
      const double nearer = first_[k], farther = all - first_[k + 1], cost = (all - nearer - farther) / (nearer * farther);
      if (best == far || cost < least) least = cost, best = k;
    }
    return best;
  }

  const Graph& graph_;
  Lists lists_;
  std::span<int> nodes_;  // those of a part stand together
  std::span<int> part_, level_;
  std::vector<int> depth_, order_, first_;
  std::vector<Part> open_;
  int parts_ = 0;
};

}  // namespace

std::vector<int> dissection(const Graph& graph) { return Dissection(graph).stages(); }

}  // namespace delassus
