#include "estimate/plateau.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>

#include "estimate/convergence.hpp"
#include "estimate/statistics.hpp"

namespace koksma {

namespace {

// Page 5, section 0.
constexpr std::size_t kFewestFlatRows = 4;
constexpr double kNumericFactor = 10;
// Rows of nearly the same N have nearly the same points, and so the same error, flat or not.
constexpr double kFewestOctaves = 3;
// Of the variance of log2 RMSE over normal replicates: below this share, they agree with each
// other.
constexpr double kAgreement = 0.25;

constexpr double kLn2 = 0.693147180559945309;

struct Point {
  double x = 0, y = 0;  // log2 N, log2 RMSE
  double rmse = 0;
  const ConvergenceRow* row = nullptr;
};

// An RMSE of 0 lies below the floor and below all others, nobody knows how far.
std::vector<Point> curve_of(const std::vector<const ConvergenceRow*>& rows) {
  std::vector<Point> points;
  double smallest = std::numeric_limits<double>::infinity();
  for (const ConvergenceRow* row : rows) {
    const double rmse = root_mean_square(row->errors);
    if (rmse > 0) smallest = std::min(smallest, rmse);
    points.push_back({std::log2(static_cast<double>(row->samples)), 0, rmse, row});
  }
  for (Point& p : points) {
    const double substitute = p.row->floor > 0 ? std::min(p.row->floor, smallest) : smallest;
    p.y = std::log2(p.rmse > 0 ? p.rmse : substitute);
  }
  return points;
}

// Least squares through the last points of a curve.
struct End {
  std::vector<Point> points;
  double slope = 0;
  double residual_error = 0;   // standard error of the slope by the scatter about the line
  double replicate_error = 0;  // by the replicates, whole paths, delta method; R ≥ 2
  bool needs_scatter = false;  // the replicates alone do not tell how firm the slope is
};

double spread_of(const std::vector<Point>& points, double mean) {
  double sum = 0;
  for (const Point& p : points) sum += (p.x - mean) * (p.x - mean);
  return sum;
}

// Slope of the line and its standard error by the scatter.
void fit_line(End& end) {
  const auto size = static_cast<double>(end.points.size());
  double mean_x = 0;
  double mean_y = 0;
  for (const Point& p : end.points) {
    mean_x += p.x / size;
    mean_y += p.y / size;
  }
  const double spread = spread_of(end.points, mean_x);
  for (const Point& p : end.points) end.slope += (p.x - mean_x) * (p.y - mean_y) / spread;
  double residual = 0;
  for (const Point& p : end.points)
    residual += std::pow(p.y - mean_y - end.slope * (p.x - mean_x), 2);
  end.residual_error = std::sqrt(residual / (size - 2) / spread);
}

// d(log2 RMSE)/d(replicate r) = (e_r² / MSE − 1)/(2 ln 2): summed over the rows of a replicate
// before it is squared, for rows share their randomizations.
void add_replicate_error(End& end) {
  const std::size_t replicates = end.points.front().row->errors.size();
  double mean_x = 0;
  for (const Point& p : end.points) mean_x += p.x / static_cast<double>(end.points.size());
  const double spread = spread_of(end.points, mean_x);
  std::vector<double> influence(replicates);
  double variance_of_rows = 0;
  for (const Point& p : end.points) {
    if (!(p.rmse > 0)) continue;
    const std::vector<double>& errors = p.row->errors;
    for (std::size_t r = 0; r < replicates; ++r) {
      const double u = (std::pow(errors[r] / p.rmse, 2) - 1) / (2 * kLn2);
      influence[r] += (p.x - mean_x) / spread * u;
      variance_of_rows += u * u;
    }
    end.needs_scatter = end.needs_scatter || p.rmse > kHeavyTailRatio * median_abs(errors);
  }
  double sum = 0;
  for (const double h : influence) sum += h * h;
  const auto size = static_cast<double>(replicates);
  end.replicate_error = std::sqrt(sum / (size * (size - 1)));
  // Of normal errors u has the variance 2/(2 ln 2)². Replicates that all make the same error are
  // one deterministic path, and heavy-tailed ones are ruled by one replicate: the same.
  const double normal = 2 / std::pow(2 * kLn2, 2);
  variance_of_rows /= size * static_cast<double>(end.points.size());
  end.needs_scatter = end.needs_scatter || variance_of_rows < kAgreement * normal;
}

End make_end(const std::vector<Point>& curve, std::size_t rows) {
  End end;
  end.points.assign(curve.end() - static_cast<std::ptrdiff_t>(rows), curve.end());
  fit_line(end);
  end.needs_scatter = end.points.front().row->errors.size() < 2;
  if (!end.needs_scatter) add_replicate_error(end);
  return end;
}

bool exceeds(double difference, double error, std::size_t freedom, double level) {
  if (!(difference > 0)) return false;
  const boost::math::students_t distribution(static_cast<double>(freedom));
  return difference > error * quantile(complement(distribution, level));
}

// Is the slope of the end above `reference`, at this level?
bool is_above(const End& end, double reference, double level) {
  const double difference = end.slope - reference;
  const std::size_t replicates = end.points.front().row->errors.size();
  if (replicates > 1 && !exceeds(difference, end.replicate_error, replicates - 1, level))
    return false;
  return !end.needs_scatter ||
         exceeds(difference, end.residual_error, end.points.size() - 2, level);
}

bool long_enough(const std::vector<Point>& curve, std::size_t rows) {
  return rows >= kFewestFlatRows && rows <= curve.size() &&
         curve.back().x - curve[curve.size() - rows].x >= kFewestOctaves;
}

// Rows at the end that are below 3 floors, as those that are excluded from the rate.
std::size_t rows_at_floor(const std::vector<Point>& curve) {
  std::size_t rows = 0;
  while (rows < curve.size()) {
    const Point& p = curve[curve.size() - 1 - rows];
    if (!(p.rmse < kFloorFactor * p.row->floor)) break;
    ++rows;
  }
  return rows;
}

Plateau describe(const End& end) {
  Plateau plateau;
  plateau.from = end.points.front().row->samples;
  plateau.rows = end.points.size();
  plateau.slope = end.slope;
  double level = 0;
  double floor = 0;
  for (const Point& p : end.points) {
    level += p.y;
    floor += std::log2(p.row->floor);
  }
  const auto size = static_cast<double>(end.points.size());
  plateau.level = std::exp2(level / size);
  if (floor > -std::numeric_limits<double>::infinity()) plateau.floor = std::exp2(floor / size);
  const bool numeric = plateau.floor && plateau.level <= kNumericFactor * *plateau.floor;
  plateau.kind = numeric ? PlateauKind::numeric : PlateauKind::structural;
  return plateau;
}

// Flat by itself, wherever it lies.
std::optional<Plateau> flat_end(const std::vector<Point>& curve) {
  const double level = kPlateauLevel / static_cast<double>(curve.size() - kFewestFlatRows + 1);
  for (std::size_t rows = curve.size(); rows >= kFewestFlatRows; --rows) {
    if (!long_enough(curve, rows)) continue;
    const End end = make_end(curve, rows);
    if (end.slope <= -kFlatSlope || !is_above(end, kSlowestRate, level)) continue;
    Plateau plateau = describe(end);
    // Rounding may also rise with N, as that of a naive sum does.
    if (end.slope >= kFlatSlope && plateau.kind != PlateauKind::numeric) continue;
    plateau.reason = fmt::format("slope {:.2f} over the last {} rows at RMSE {:.2g}, ",
                                 plateau.slope, rows, plateau.level);
    plateau.reason += plateau.floor ? fmt::format("the estimated floor is {:.2g}", *plateau.floor)
                                    : "no floor is known";
    return plateau;
  }
  return std::nullopt;
}

// At the floor, where flat is what a curve must become: the slope alone decides, as page 5 has it.
std::optional<Plateau> end_at_floor(const std::vector<Point>& curve) {
  for (std::size_t rows = rows_at_floor(curve); rows >= kFewestFlatRows; --rows) {
    if (!long_enough(curve, rows)) break;
    const End end = make_end(curve, rows);
    if (end.slope <= -kFlatSlope) continue;
    Plateau plateau = describe(end);
    plateau.reason =
        fmt::format("slope {:.2f} over the last {} rows, all below 3 estimated floors of {:.2g}",
                    plateau.slope, rows, *plateau.floor);
    return plateau;
  }
  return std::nullopt;
}

Plateau none_because(std::string_view reason) {
  Plateau none;
  none.reason = reason;
  return none;
}

// Residual sum of squares of y on 1, x and max(x − knot, 0), the last left out for an infinite
// knot.
struct Stick {
  double residual = 0, slope = 0, change = 0;
};

// Regressors made orthogonal one after the other (Gram and Schmidt): at most three, so nothing is
// lost by it.
Stick fit_stick(const std::vector<Point>& points, double knot) {
  const std::size_t size = points.size();
  const auto centre = [size](std::vector<double>& v) {
    double mean = 0;
    for (const double value : v) mean += value / static_cast<double>(size);
    for (double& value : v) value -= mean;
  };
  const auto dot = [size](const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < size; ++i) sum += a[i] * b[i];
    return sum;
  };
  const auto remove = [size](std::vector<double>& from, const std::vector<double>& v,
                             double times) {
    for (std::size_t i = 0; i < size; ++i) from[i] -= times * v[i];
  };
  std::vector<double> x, hinge, y;
  for (const Point& p : points) {
    x.push_back(p.x);
    hinge.push_back(std::max(p.x - knot, 0.0));
    y.push_back(p.y);
  }
  centre(x);
  centre(hinge);
  centre(y);
  Stick stick;
  stick.slope = dot(x, y) / dot(x, x);
  remove(y, x, stick.slope);
  if (std::isfinite(knot)) {
    const double along = dot(x, hinge) / dot(x, x);
    remove(hinge, x, along);
    stick.change = dot(hinge, y) / dot(hinge, hinge);
    stick.slope -= stick.change * along;
    remove(y, hinge, stick.change);
  }
  stick.residual = dot(y, y);
  return stick;
}

// Burnham & Anderson, section 2.4, for least squares; the scatter is a parameter, too. Less scatter
// than a millionth of an octave is rounding.
double aicc(double residual, std::size_t size, double parameters) {
  const auto n = static_cast<double>(size);
  return n * std::log(std::max(residual / n, 1e-12)) + 2 * parameters +
         2 * parameters * (parameters + 1) / (n - parameters - 1);
}

}  // namespace

std::string_view plateau_name(PlateauKind kind) {
  switch (kind) {
    case PlateauKind::numeric:
      return "numeric";
    case PlateauKind::structural:
      return "structural";
    case PlateauKind::none:
      break;
  }
  return "none";
}

Plateau find_plateau(const std::vector<const ConvergenceRow*>& rows) {
  const std::vector<Point> curve = curve_of(rows);
  if (curve.size() < kFewestFlatRows) return none_because("fewer than 4 rows");
  // Exact results are not stuck, however few.
  if (curve.back().rmse == 0) return none_because("the last rows are exact");
  if (auto plateau = end_at_floor(curve)) return *plateau;
  if (auto plateau = flat_end(curve)) return *plateau;
  return none_because("the end is not flat");
}

std::optional<Break> find_break(const std::vector<const ConvergenceRow*>& rows) {
  constexpr std::size_t kFewestRows = 7;  // 5 parameters and the one that AICc divides by
  constexpr double kStep = 1.0 / 16;      // octaves
  constexpr double kAccepted = 6;
  const std::vector<Point> curve = curve_of(rows);
  if (curve.size() < kFewestRows) return std::nullopt;
  if (std::any_of(curve.begin(), curve.end(), [](const Point& p) { return !(p.rmse > 0); }))
    return std::nullopt;
  const Stick line = fit_stick(curve, std::numeric_limits<double>::infinity());

  // Two rows or more on either side, so that no single row is a segment of its own.
  Stick best;
  best.residual = std::numeric_limits<double>::infinity();
  double knot = 0;
  for (double x = curve[1].x; x <= curve[curve.size() - 2].x; x += kStep) {
    const Stick stick = fit_stick(curve, x);
    if (stick.residual < best.residual) {
      best = stick;
      knot = x;
    }
  }
  const double gain = aicc(line.residual, curve.size(), 3) - aicc(best.residual, curve.size(), 5);
  if (!(gain > kAccepted)) return std::nullopt;
  return Break{knot, best.slope, best.slope + best.change, gain};
}

}  // namespace koksma
