#include "stability/summation_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include "device/integrator.hpp"
#include "estimate/exact_sum.hpp"
#include "estimate/summation.hpp"
#include "stability/specimens.hpp"

namespace koksma {
namespace {

using Clock = std::chrono::steady_clock;

constexpr unsigned kLog2Lanes = 4;
constexpr unsigned kLog2Tenths = 20;           // terms per lane under relaxed math
constexpr std::uint64_t kHostTerms = 1 << 16;  // of a comparison with the host
constexpr Precision kTablePrecision = Precision::fp32;
const Terms kOnes{"1", 1, 0, 0};
const Terms kTenths{"0.1", static_cast<double>(0.1F), 0, 0};
const std::vector<Terms> kRandomTerms{
    {"U(0,1)", 0, 1, 0}, {"U - 1/2", -0.5, 1, 0}, {"U +- 1000", 0, 1, 1000}};

struct Measured {
  ExactSum sum;
  double seconds = 0;
};

// One sum's program, run with any terms and any number of them.
class TermsRun {
 public:
  TermsRun(const Catalog& catalog, Device& device, const SumAlgorithm& sum, unsigned log2_most,
           bool relaxed = false)
      : device_(device) {
    PlanOptions options;
    options.relaxed_math = relaxed;
    // Two items of a block on a CPU: one work-item would use one core.
    options.shape = LaunchShape{device.facts().is_cpu ? 8U : 1U, 1, std::nullopt, std::nullopt};
    const Cell cell = terms_cell(catalog, sum.name, kTablePrecision, std::uint64_t{1} << log2_most);
    plan_ = make_plan(catalog, cell, device.facts(), "", options);
  }

  Measured run(const Terms& terms, unsigned log2_n, bool absolute = false) {
    Integrator& f = integrator(terms, absolute);
    Measured result;
    result.seconds =
        f.run_blocks(std::uint64_t{1} << log2_n, log2_n, 0, 1, 1, 0.0,
                     [&](std::uint32_t word, std::uint32_t, std::span<const double> partials) {
                       result.sum.add(partials, plan_.word_exponent(word));
                     });
    return result;
  }

  std::vector<double> values(const Terms& terms) {
    return integrator(terms, false).first_values(kHostTerms);
  }

 private:
  // Parameters are uploaded by the integrator; its program is built once by the device.
  Integrator& integrator(const Terms& terms, bool absolute) {
    plan_.cell.scene.parameters = terms.parameters(absolute);
    integrator_.emplace(device_, plan_, std::vector<double>{});
    return *integrator_;
  }

  Device& device_;
  Plan plan_;
  std::optional<Integrator> integrator_;
};

bool is_exact(const SumAlgorithm& sum) { return sum.bound.empty() && sum.quantum == 0; }

// |sum - exact| / |exact|, the difference exact.
double relative_error(const ExactSum& sum, const ExactSum& exact) {
  ExactSum difference = sum;
  difference.subtract(exact);
  return std::fabs(difference.rounded() / exact.rounded());
}

// A row's terms and their exact sum, by the host for constants and by an exact sum of the device's.
struct Exact {
  Terms terms;
  unsigned log2_n = 0;
  ExactSum sum;
  double kappa = 1;
};

std::vector<Exact> exact_rows(TermsRun& exact, const SummationOptions& options) {
  std::vector<Exact> rows;
  for (const Terms& terms : {kOnes, kTenths}) {
    for (const unsigned n : options.constants) {
      Exact row{terms, n + kLog2Lanes, {}, 1};
      row.sum.add_product(terms.offset, std::uint64_t{1} << row.log2_n);
      rows.push_back(row);
    }
  }
  for (const Terms& terms : kRandomTerms) {
    for (const unsigned n : options.random) {
      Exact row{terms, n + kLog2Lanes, {}, 1};
      row.sum = exact.run(terms, row.log2_n).sum;
      row.kappa = std::fabs(exact.run(terms, row.log2_n, true).sum.rounded() / row.sum.rounded());
      rows.push_back(row);
    }
  }
  return rows;
}

// The same bits as the host's exact sum of the values themselves.
bool agrees_with_host(TermsRun& exact) {
  ExactSum host;
  host.add(exact.values(kRandomTerms.back()));
  return host.rounded() == exact.run(kRandomTerms.back(), 16).sum.rounded();
}

// Exact and fixed-point sums are slow beside the others, and 2^24 equal terms are more than words
// of fp32 hold.
unsigned log2_most_terms(const SumAlgorithm& sum) { return sum.order_free ? 24 : 63; }

SummationEntry measure_entry(TermsRun& run, const SumAlgorithm& sum, const Exact& row) {
  const Measured measured = run.run(row.terms, row.log2_n);
  const double n = std::ldexp(1.0, static_cast<int>(row.log2_n - kLog2Lanes));
  const double mean_abs =
      std::fabs(row.sum.rounded()) * row.kappa / std::ldexp(1.0, static_cast<int>(row.log2_n));
  const double bound = summation_bound(sum, kTablePrecision, n).of(mean_abs) / mean_abs * row.kappa;
  // Four times the terms at which nothing is guaranteed any more: that of 1s must show.
  const bool exhausted =
      row.terms.name == kOnes.name && summation_bound(sum, kTablePrecision, n / 4).relative >= 1;
  return {sum.name, relative_error(measured.sum, row.sum), bound, exhausted, measured.seconds};
}

RelaxedSum compare_relaxed(TermsRun& strict, TermsRun& relaxed, const SumAlgorithm& sum) {
  ExactSum exact;
  exact.add_product(kTenths.offset, std::uint64_t{1} << (kLog2Tenths + kLog2Lanes));
  const ExactSum a = strict.run(kTenths, kLog2Tenths + kLog2Lanes).sum;
  const ExactSum b = relaxed.run(kTenths, kLog2Tenths + kLog2Lanes).sum;
  return {sum.name, sum.compensated, relative_error(a, exact), relative_error(b, exact),
          a.rounded() != b.rounded()};
}

std::string why_row_wrong(const SummationRow& row) {
  for (const SummationEntry& entry : row.entries) {
    const auto complain = [&](const std::string& what) {
      return fmt::format("sum '{}' of {} terms {} per lane: error {:.2e}, {}", entry.sum,
                         row.n_per_lane, row.terms, entry.error, what);
    };
    if (!(entry.error <= entry.bound * (1 + 1e-3)))
      return complain(fmt::format("above its bound {:.2e}", entry.bound));
    if (entry.exhausted && !(entry.error >= 0.5))
      return complain("although its words are too short: it should have stagnated");
  }
  return "";
}

std::string why_wrong(const SummationTable& table, const EftResult& relaxed_self_test) {
  if (!table.host_agrees) return "an exact sum differs from the host's of the same values";
  for (const SummationRow& row : table.rows)
    if (std::string why = why_row_wrong(row); !why.empty()) return why;
  for (const RelaxedSum& sum : table.relaxed)
    if (sum.compensated && sum.changed && relaxed_self_test.intact())
      return fmt::format("relaxed math changes sum '{}' and the self-test does not notice",
                         sum.sum);
  return "";
}

}  // namespace

SummationTable measure_summation(const Catalog& with_terms, Device& device,
                                 const EftResult& relaxed_self_test,
                                 const SummationOptions& options) {
  const auto start = Clock::now();
  SummationTable table;
  table.precision = kTablePrecision;
  const auto exact_sum = std::find_if(with_terms.sums.begin(), with_terms.sums.end(), is_exact);
  const unsigned most = *std::max_element(options.constants.begin(), options.constants.end());
  TermsRun exact(with_terms, device, *exact_sum, most + kLog2Lanes);
  const std::vector<Exact> rows = exact_rows(exact, options);
  for (const Exact& row : rows)
    table.rows.push_back(
        {row.terms.name, std::uint64_t{1} << (row.log2_n - kLog2Lanes), row.kappa, {}});
  table.host_agrees = agrees_with_host(exact);
  for (const SumAlgorithm& sum : with_terms.sums) {
    if (sum.needs_fp64 && !device.facts().fp64) continue;
    TermsRun run(with_terms, device, sum, most + kLog2Lanes);
    for (std::size_t i = 0; i < rows.size(); ++i)
      if (rows[i].log2_n <= log2_most_terms(sum) + kLog2Lanes)
        table.rows[i].entries.push_back(measure_entry(run, sum, rows[i]));
    if (!options.relaxed_math) continue;
    TermsRun relaxed(with_terms, device, sum, most + kLog2Lanes, true);
    table.relaxed.push_back(compare_relaxed(run, relaxed, sum));
  }
  table.why = why_wrong(table, relaxed_self_test);
  table.ok = table.why.empty();
  table.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  return table;
}

}  // namespace koksma
