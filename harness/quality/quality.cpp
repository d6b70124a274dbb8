#include "quality/quality.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "quality/discrepancy.hpp"
#include "quality/net.hpp"
#include "quality/star.hpp"

namespace koksma {
namespace {

std::string too_much(const std::string& what, double found, double allowed) {
  return fmt::format("too expensive: {} = {:.3g}, the limit is {:.3g}", what, found, allowed);
}

// The reason where a computed number is none.
Measure checked_measure(Measure measure, double value, const std::string& when_bad) {
  // They are all above 0 for finitely many points.
  if (std::isnormal(value) && value > 0)
    measure.value = value;
  else
    measure.reason = when_bad;
  return measure;
}

const char* const kStarTitle = "star discrepancy D*";

std::vector<Measure> star_known(QualityKernels& kernels, const PointSet& points) {
  Measure exact{"star",
                kStarTitle,
                star_exact(kernels, points),
                "exact",
                std::nullopt,
                points.dim == 1
                    ? "1/(2N) + max |x_(i) - (2i - 1)/(2N)|, Niederreiter (1992), theorem 2.6"
                    : "all critical boxes, open and closed, Niederreiter, Math. Ann. 194 (1972)",
                ""};
  Measure lower = exact, upper = exact;
  lower.name = "star_lower";
  upper.name = "star_upper";
  return {exact, lower, upper};
}

Measure star_below(QualityKernels& kernels, const PointSet& points, const QualityLimits& limits) {
  Measure measure{"star_lower",
                  kStarTitle,
                  std::nullopt,
                  "lower-bound",
                  std::nullopt,
                  "threshold accepting after Winker and Fang, SIAM J. Numer. Anal. 34 (1997), and "
                  "Gnewuch, Wahlstroem and Winzen, SIAM J. Numer. Anal. 50 (2012)",
                  ""};
  StarSearch search;
  search.rounds = 128;
  while (search.rounds > 8 && star_search_work(points, search) > limits.search_visits)
    search.rounds /= 2;
  const double work = star_search_work(points, search);
  if (work > limits.search_visits) {
    measure.reason = too_much("point visits of the shortest search", work, limits.search_visits);
    return measure;
  }
  measure.value = star_lower_bound(kernels, points, search);
  measure.method += fmt::format(", {} chains of {} boxes, seed {}", search.chains,
                                search.rounds * search.rounds, search.seed);
  return measure;
}

// The finest resolution that is affordable, but no finer than a tenth of what is to be bounded.
std::optional<double> affordable_resolution(const PointSet& points, double lower,
                                            const QualityLimits& limits) {
  const double visits = 2 * static_cast<double>(points.x.size());
  const auto most =
      static_cast<std::uint64_t>(std::min(limits.cover_visits / visits, limits.cover_brackets));
  std::optional<double> best;
  for (double resolution = 0.5; resolution >= lower / 10; resolution *= 0.8) {
    if (!cover_size(points.dim, resolution, most)) break;
    best = resolution;
  }
  return best;
}

Measure star_above(QualityKernels& kernels, const PointSet& points, double lower,
                   const QualityLimits& limits) {
  Measure measure{"star_upper",
                  kStarTitle,
                  std::nullopt,
                  "upper-bound",
                  std::nullopt,
                  "bracketing cover, Thiemard, J. Complexity 17 (2001)",
                  ""};
  const auto resolution = affordable_resolution(points, lower, limits);
  if (!resolution) {
    measure.reason = fmt::format(
        "too expensive: in d = {}, a cover of resolution 0.5 takes more than {:.3g} brackets or "
        "{:.3g} "
        "point visits",
        points.dim, limits.cover_brackets, limits.cover_visits);
    return measure;
  }
  const StarCover cover = star_upper_bound(kernels, points, *resolution);
  measure.value = cover.bound;
  measure.method += fmt::format(", {} brackets of resolution {:.3g}", cover.brackets, *resolution);
  return measure;
}

std::vector<Measure> star_measures(QualityKernels& kernels, const PointSet& points,
                                   const QualityLimits& limits) {
  const double allowed[3] = {limits.star_1d_n, limits.star_2d_n, limits.star_3d_n};
  const auto n = static_cast<double>(points.size());
  if (points.dim <= 3 && n <= allowed[points.dim - 1]) return star_known(kernels, points);
  Measure exact{"star", kStarTitle, std::nullopt, "exact", std::nullopt, "", ""};
  exact.reason = points.dim > 3
                     ? fmt::format("d = {}: exact only for d <= 3; see its bounds", points.dim)
                     : too_much(fmt::format("N in d = {}", points.dim), n, allowed[points.dim - 1]);
  const Measure lower = star_below(kernels, points, limits);
  const Measure upper = star_above(kernels, points, lower.value.value_or(0.1), limits);
  return {exact, lower, upper};
}

std::vector<Measure> pair_measures(QualityKernels& kernels, const PointSet& points,
                                   const QualityLimits& limits) {
  const auto measure = [](const char* name, const char* title, std::optional<bool> squared,
                          const char* method) {
    return Measure{name, title, std::nullopt, "exact", squared, method, ""};
  };
  std::vector<Measure> all{
      measure("l2star", "L2-star discrepancy", false, "Warnock (1972), the root, as SciPy"),
      measure("cd2", "centred L2 discrepancy, squared", true,
              "Hickernell, Math. Comp. 67 (1998), squared, as SciPy's CD"),
      measure("wd2", "wrap-around L2 discrepancy, squared", true,
              "Hickernell, Lecture Notes in Statistics 138 (1998), squared, as SciPy's WD"),
      measure("md2", "mixture L2 discrepancy, squared", true,
              "Zhou, Fang and Ning, J. Complexity 29 (2013), eq. 18, squared, as SciPy's MD"),
      measure("diaphony", "diaphony F", false,
              "Zinterhof (1976), the root of N^-2 sum prod (1 + 2 pi^2 B_2({x - y})) - 1"),
      measure("minimum_distance", "minimum toroidal distance", std::nullopt,
              "Euclidean distance on the torus, all pairs")};
  const auto n = static_cast<double>(points.size());
  const double work = n * n * points.dim;
  if (work > limits.pair_terms) {
    for (Measure& m : all) m.reason = too_much("N^2 d", work, limits.pair_terms);
    return all;
  }
  const L2Discrepancies l2 = l2_discrepancies(kernels, points);
  const double squares[5] = {l2.l2star2, l2.cd2, l2.wd2, l2.md2, l2.diaphony2};
  for (std::size_t i = 0; i < 5; ++i) {
    // Sums of N numbers near 1 that cancel: in fp32 nothing below this is left of them.
    const bool lost = !kernels.fp64() && squares[i] < 0x1p-24 * n;
    all[i] = checked_measure(all[i],
                             lost              ? 0
                             : *all[i].squared ? squares[i]
                                               : std::sqrt(squares[i]),
                             lost ? "the device has no fp64, and this is below the rounding of fp32"
                             : !std::isfinite(squares[i]) ? "beyond the range of a double"
                             : std::fabs(squares[i]) < 1e-290
                                 ? "below the range of a double"
                                 : "the square is below its rounding error");
  }
  if (points.size() < 2)
    all[5].reason = "one point has no distance";
  else
    all[5].value = minimum_toroidal_distance(kernels, points);
  return all;
}

// Twice the radius over the largest that N equal disks on the torus can have (Lagae & Dutre 2008).
Measure relative_radius(const PointSet& points, const Measure& distance) {
  Measure measure{
      "relative_radius",
      "minimum distance over that of the densest packing",
      std::nullopt,
      "exact",
      std::nullopt,
      "Lagae and Dutre, Comput. Graph. Forum 27 (2008): r / sqrt(1 / (2 sqrt(3) N)), r half "
      "the minimum distance",
      ""};
  if (points.dim != 2)
    measure.reason = fmt::format("d = {}: only for d = 2", points.dim);
  else if (!distance.value)
    measure.reason = distance.reason;
  else
    measure.value =
        *distance.value / 2 * std::sqrt(2 * std::sqrt(3.0) * static_cast<double>(points.size()));
  return measure;
}

Measure net_measure(QualityKernels& kernels, const PointSet& points) {
  const NetParameter net = net_parameter(kernels, points);
  Measure measure{
      "t",          "net parameter t in base 2",
      std::nullopt, "exact",
      std::nullopt, "all elementary intervals counted, Niederreiter (1992), definition 4.1",
      net.reason};
  if (net.t) measure.value = *net.t;
  return measure;
}

void add_planar(QualityKernels& kernels, const std::vector<PointSet>& sets,
                const QualityLimits& limits, Quality& quality) {
  const PointSet& first = sets.front();
  if (first.dim != 2 || first.size() < 2) {
    quality.pair_correlation_reason = quality.power_spectrum_reason =
        first.dim != 2 ? fmt::format("d = {}: only for d = 2", first.dim) : "one point";
    return;
  }
  const auto n = static_cast<double>(first.size()), count = static_cast<double>(sets.size());
  if (const double pairs = n * n / 2 * count; pairs <= limits.histogram_pairs)
    quality.pair_correlation = pair_correlation(kernels, sets);
  else
    quality.pair_correlation_reason = too_much("pairs times sets", pairs, limits.histogram_pairs);
  const std::uint32_t reach = spectrum_reach(first.size());
  const double terms = n * (reach + 1.0) * (2.0 * reach + 1) * count;
  if (terms <= limits.spectrum_terms)
    quality.power_spectrum = power_spectrum(kernels, sets, reach);
  else
    quality.power_spectrum_reason =
        too_much("points times frequencies times sets", terms, limits.spectrum_terms);
}

}  // namespace

const Measure& Quality::measure(const std::string& name) const {
  const auto found = std::find_if(measures.begin(), measures.end(),
                                  [&](const Measure& m) { return m.name == name; });
  if (found == measures.end()) throw std::out_of_range("no measure " + name);
  return *found;
}

Quality measure_quality(QualityKernels& kernels, const std::vector<PointSet>& sets,
                        const QualityLimits& limits) {
  Quality quality;
  quality.sets = static_cast<std::uint32_t>(sets.size());
  const PointSet& first = sets.front();
  quality.measures = star_measures(kernels, first, limits);
  for (Measure& m : pair_measures(kernels, first, limits)) quality.measures.push_back(std::move(m));
  quality.measures.push_back(relative_radius(first, quality.measure("minimum_distance")));
  quality.measures.push_back(net_measure(kernels, first));
  add_planar(kernels, sets, limits, quality);
  return quality;
}

}  // namespace koksma
