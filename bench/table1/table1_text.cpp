#include <algorithm>
#include <cmath>

#include "bench/table1/table1.h"
#include "bench/table1/table1_paper.h"
#include "bench/text.h"

namespace delassus::bench {

namespace {

using Cells = std::vector<std::vector<std::string>>;

std::string times(double x) { return three_digits(x) + (std::isnan(x) ? "" : "×"); }
std::string as_printed(double x) { return format("%g", x); }

/// The median, or why there is none.
std::string time_or_why(const Entry* e, Use use) {
  if (e == nullptr) return "not asked";
  return e->has(use) ? three_digits(e->median(use)) : e->why_not[static_cast<std::size_t>(use)];
}
double ratio(const Entry* of, const Entry* to, Use use) { return of && to && of->has(use) && to->has(use) ? of->median(use) / to->median(use) : NAN; }

/// `yes` where the ratio of this table and the paper's lie on the same side of 1, or within a tenth of it.
std::string same_direction(double ours, double papers) {
  if (std::isnan(ours)) return "–";
  return (ours > 1) == (papers > 1) || std::fabs(std::log(ours)) < std::log(1.1) ? "yes" : "**no**";
}

bool is_of_paper(const TableRow& r) {
  const auto& rows = paper_rows();
  return std::any_of(rows.begin(), rows.end(), [&](const PaperRow& p) { return r.scene == p.scene; });
}

std::string rows_text(const TableRow& r) {
  const std::string own = std::to_string(r.rows);
  return !is_of_paper(r) || paper_row(r.scene).rows == r.rows ? own : own + " (" + std::to_string(paper_row(r.scene).rows) + ")";
}

struct First {
  Use use;
  const char *free, *title;
  PaperFigures PaperRow::*paper_free, PaperRow::*paper_explicit;
};
constexpr First firsts[] = {{Use::first_apply, free_product, "Λ⁻¹, first evaluation", &PaperRow::free_apply, &PaperRow::explicit_apply},
                            {Use::first_solve, free_inverse, "Λ_R, first evaluation", &PaperRow::free_solve, &PaperRow::explicit_solve}};

std::string first_table(const TableOne& t, const First& f) {
  Cells cells{{"scene", "n_v", "rows", "kinematics", f.free, "with kinematics", explicit_baseline, "with kinematics", "ratio", "paper", "paper: explicit", "paper: ratio", "same direction", "best explicit"}};
  for (const TableRow& r : t.rows) {
    const Entry *free = r.find(f.free), *base = r.find(explicit_baseline), *best = r.best(f.use, true);
    const auto with = [&](const Entry* e) { return e && e->has(f.use) ? three_digits(e->median(f.use) + r.kinematics.median) : "–"; };
    cells.push_back({r.scene, std::to_string(r.dofs), rows_text(r), three_digits(r.kinematics.median), time_or_why(free, f.use), with(free),
                     time_or_why(base, f.use), with(base), times(ratio(base, free, f.use))});
    if (is_of_paper(r)) {
      const PaperRow& p = paper_row(r.scene);
      const double papers = (p.*f.paper_explicit).time / (p.*f.paper_free).time;
      for (const std::string& s : {as_printed((p.*f.paper_free).time), as_printed((p.*f.paper_explicit).time), times(papers), same_direction(ratio(base, free, f.use), papers)})
        cells.back().push_back(s);
    } else {
      cells.back().insert(cells.back().end(), 4, "not in it");
    }
    cells.back().push_back(best ? best->op + " " + three_digits(best->median(f.use)) : "none");
  }
  return std::string("### ") + f.title + " [µs]\n" + markdown_table(cells);
}

std::string again_table(const TableOne& t) {
  struct Column {
    Use use;
    const char *free, *title;
  };
  constexpr Column columns[] = {{Use::apply, free_product, "Λ⁻¹"}, {Use::solve, free_inverse, "Λ_R"}, {Use::new_damping, free_inverse, "Λ'_R"}};
  Cells cells{{"scene"}};
  for (const Column& c : columns)
    for (const char* what : {": free", ": explicit", ": ratio", ": paper"}) cells[0].push_back(c.title + std::string(what));
  for (const TableRow& r : t.rows) {
    cells.push_back({r.scene});
    for (std::size_t k = 0; k < std::size(columns); ++k) {
      const Entry *free = r.find(columns[k].free), *base = r.find(explicit_baseline);
      for (const std::string& s : {time_or_why(free, columns[k].use), time_or_why(base, columns[k].use), times(ratio(base, free, columns[k].use))}) cells.back().push_back(s);
      cells.back().push_back(is_of_paper(r) ? times(paper_row(r.scene).explicit_again[k] / paper_row(r.scene).free_again[k]) : "not in it");
    }
  }
  return std::string("### Again: a second vector, and a new damping with one solve [µs]\n`") + free_product + "` for Λ⁻¹ and `" + free_inverse + "` for Λ_R against `" +
         explicit_baseline + "`; a ratio below 1: explicit is faster.\n\n" + markdown_table(cells);
}

std::string memory_table(const TableOne& t) {
  Cells cells{{"scene"}};
  const char* const ops[] = {free_product, free_inverse, explicit_baseline};
  const Use of[] = {Use::first_apply, Use::first_solve, Use::first_solve};
  for (const char* op : ops) cells[0].push_back(std::string(op));
  cells[0].insert(cells[0].end(), {"paper Λ⁻¹, Λ_R, explicit [kB]"});
  for (const char* op : ops) cells[0].push_back(std::string(op) + ": lines");
  cells[0].push_back("paper [10³ lines]");
  for (const TableRow& r : t.rows) {
    cells.push_back({r.scene});
    for (const char* op : ops) cells.back().push_back(r.find(op) ? short_bytes(r.find(op)->bytes) : "not asked");
    const auto paper = [&](double PaperFigures::*x) {
      if (!is_of_paper(r)) return std::string("not in it");
      const PaperRow& p = paper_row(r.scene);
      return as_printed(p.free_apply.*x) + ", " + as_printed(p.free_solve.*x) + ", " + as_printed(p.explicit_solve.*x);
    };
    cells.back().push_back(paper(&PaperFigures::kilobytes));
    for (std::size_t k = 0; k < std::size(ops); ++k) {
      const Entry* e = r.find(ops[k]);
      const std::int64_t lines = e ? e->lines[static_cast<std::size_t>(of[k])] : -1;
      cells.back().push_back(lines < 0 ? "not counted" : short_count(lines));
    }
    cells.back().push_back(paper(&PaperFigures::lines));
  }
  return "### Memory: bytes held, and distinct cache lines of 64 bytes touched by a first evaluation\n" +
         (t.lines_counted_with.empty() ? std::string("Cache lines were not counted: `scripts/build avx2 phase_probe`, then `--cache-lines build/avx2/bench/phase_probe`.\n\n")
                                       : "Cache lines by callgrind, kernels: " + t.lines_counted_with + ". `" + explicit_baseline + "` holds J M⁻¹Jᵀ, A and its factor.\n\n") +
         markdown_table(cells);
}

std::string accuracy_table(const TableOne& t) {
  Cells cells{{"scene", "R⁻¹ [1/kg]", "κ(A)", std::string(free_product) + ": a", "reference", explicit_baseline + std::string(": a"), ": λ", ": motion", free_inverse + std::string(": λ"),
               ": motion", certified_inverse + std::string(": λ"), ": motion", "certificate", "first / " + std::string(free_inverse), "of which certificate", "worst of all"}};
  for (const TableRow& r : t.rows) {
    const Entry *free = r.find(free_product), *base = r.find(explicit_baseline), *inverse = r.find(free_inverse), *certified = r.find(certified_inverse);
    const auto error = [](const Entry* e, double Entry::*x) { return e ? rough_digit(e->*x) : std::string("not asked"); };
    const Entry* worst = nullptr;
    for (const Entry& e : r.entries)
      if (!std::isnan(e.worst_error()) && (!worst || e.worst_error() > worst->worst_error())) worst = &e;
    const std::string damping = format("%g", r.smallest_damping) + (r.smallest_damping == r.largest_damping ? "" : format(" … %g", r.largest_damping));
    const double extra = certified && certified->has(Use::fast_first_solve) ? certified->median(Use::first_solve) / certified->of(Use::fast_first_solve).median : NAN;
    cells.push_back({r.scene, damping, rough_digit(r.condition), error(free, &Entry::product_error), r.product_reference, error(base, &Entry::product_error),
                     error(base, &Entry::force_error), error(base, &Entry::motion_error), error(inverse, &Entry::force_error), error(inverse, &Entry::motion_error),
                     error(certified, &Entry::force_error), error(certified, &Entry::motion_error),
                     certified ? (certified->bound < 0 ? "none" : rough_digit(certified->bound)) : "not asked", times(ratio(certified, inverse, Use::first_solve)), times(extra),
                     worst ? worst->op + " " + rough_digit(worst->worst_error()) : "–"});
  }
  return "### Accuracy: relative errors against 113 bits, damping, and what a certificate adds\na: of the product; λ: of the largest force; motion: ‖δν‖_M/‖ν‖_M. The last but one: first solve with refinement "
         "and certificate over the same without.\n\n" + markdown_table(cells);
}

/// Where operators with a matrix win, use by use, with their ratio; where they lose, likewise.
std::string winners(const TableOne& t) {
  struct Row {
    Use use;
    const char* title;
  };
  constexpr Row rows[] = {{Use::first_apply, "Λ⁻¹ first"}, {Use::first_solve, "Λ_R first"}, {Use::apply, "Λ⁻¹ again"}, {Use::solve, "Λ_R again"}, {Use::new_damping, "Λ'_R"}};
  Cells cells{{"scene"}};
  for (const Row& row : rows) cells[0].push_back(row.title);
  cells[0].insert(cells[0].end(), {"explicit from … products", "explicit from … solves"});
  std::array<int, std::size(rows)> won{};
  for (const TableRow& r : t.rows) {
    cells.push_back({r.scene});
    for (std::size_t k = 0; k < std::size(rows); ++k) {
      const Entry *matrix = r.best(rows[k].use, true), *free = r.best(rows[k].use, false);
      const double lead = ratio(free, matrix, rows[k].use);
      won[k] += lead > 1;
      cells.back().push_back(!matrix || !free ? "no contest" : lead > 1 ? "**explicit** " + times(lead) + " " + matrix->op : "free " + times(1 / lead) + " " + free->op);
    }
    for (const double n : {crossover(r, Use::first_apply, Use::apply), crossover(r, Use::first_solve, Use::solve)})
      cells.back().push_back(std::isnan(n) ? "never" : format("%.0f", n));
  }
  std::string s = "### Who wins\nThe best operator that keeps a matrix against the best that does not, without asking for a certificate. Explicit wins";
  for (std::size_t k = 0; k < std::size(rows); ++k) s += std::string(k ? ", " : " ") + rows[k].title + format(": %d of %zu", won[k], t.rows.size());
  return s + " scenes. The last columns: the number of vectors at one configuration from which on a matrix costs less, its making included.\n\n" + markdown_table(cells);
}

std::string operators_table(const TableOne& t, Use use, const char* title) {
  Cells cells{{"operator"}};
  for (const TableRow& r : t.rows) cells[0].push_back(r.scene);
  if (t.rows.empty()) return "";
  std::vector<std::string> refused;
  for (const Entry& first : t.rows.front().entries) {
    std::vector<std::string> line{first.op};
    bool any = false;
    for (const TableRow& r : t.rows) {
      const Entry *e = r.find(first.op), *base = r.find(explicit_baseline);
      const double x = ratio(e, base, use);
      line.push_back(e && !e->has(use) ? e->why_not[static_cast<std::size_t>(use)] : three_digits(std::isnan(x) && e ? e->median(use) : x));
      any = any || (e && e->has(use));
    }
    if (any) cells.push_back(line);
    else refused.push_back(first.op + " " + first.why_not[static_cast<std::size_t>(use)]);
  }
  std::string none;
  for (const std::string& r : refused) none += (none.empty() ? "" : ", ") + r;
  return std::string("#### ") + title + "\n" + markdown_table(cells) + (none.empty() ? "" : "\nOn none of them: " + none + ".\n");
}

std::string spread_line(const TableOne& t) {
  std::vector<double> wide;
  for (const TableRow& r : t.rows)
    for (const Entry& e : r.entries)
      for (std::size_t u = 0; u < use_count; ++u)
        if (e.has(use(u))) wide.push_back((e.time[u].high - e.time[u].low) / e.time[u].median);
  if (wide.empty()) return "";
  std::sort(wide.begin(), wide.end());
  return format(" The distance of the quartiles is %.0f %% of the median in the middle, above %.0f %% in one cell of ten.", 100 * wide[wide.size() / 2], 100 * wide[wide.size() * 9 / 10]);
}

}  // namespace

std::string table_text(const TableOne& t) {
  const Machine& m = t.machine;
  std::string s = m.processor + ", " + m.system + "; " + m.compiler + " " + m.flags + "; kernels: " + t.kernels + "; revision " + m.revision + ", " + m.date +
                  format("; load average %.1f on %d cores at the start.\n", t.load, m.cores) + "Medians of up to 15 rounds, all operators of a scene in turn, by the clock of the thread." + spread_line(t) + "\n";
  if (t.interrupted) s += "**Interrupted**: scenes are missing.\n";
  for (const First& f : firsts) s += "\n" + first_table(t, f);
  s += "\n" + again_table(t) + "\n" + winners(t) + "\n" + memory_table(t) + "\n" + accuracy_table(t);
  s += std::string("\n### Every operator: time over that of `") + explicit_baseline + "` on the same scene\n";
  s += operators_table(t, Use::first_apply, "Λ⁻¹, first evaluation") + "\n" + operators_table(t, Use::apply, "Λ⁻¹ again") + "\n" + operators_table(t, Use::first_solve, "Λ_R, first evaluation") +
       "\n" + operators_table(t, Use::solve, "Λ_R again") + "\n" + operators_table(t, Use::new_damping, "Λ'_R: a new damping and one solve");
  return s;
}

}  // namespace delassus::bench
