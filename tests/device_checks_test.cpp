// The device checks of koksma stability at small sizes: what appendix C says of sums, what no
// launch shape may change, indices, denormals.
#include "stability/device_checks.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "stability/specimens.hpp"
#include "tests/support.hpp"

using namespace koksma;

namespace {

const SummationEntry& entry(const SummationTable& table, const std::string& terms,
                            std::uint64_t n_per_lane, const std::string& sum) {
  for (const SummationRow& row : table.rows)
    if (row.terms == terms && row.n_per_lane == n_per_lane)
      for (const SummationEntry& e : row.entries)
        if (e.sum == sum) return e;
  throw std::out_of_range(sum);
}

}  // namespace

TEST_CASE("naive fp32 sums of 1 stop at 2^24, Neumaier's lose half, the others hold", "[device]") {
  const Catalog catalog = with_terms(test::catalog());
  SummationOptions options;
  options.constants = {20, 25, 26};
  options.random = {12};
  const EftResult relaxed = test_error_free_transformations(test::catalog(), test::device(),
                                                            Precision::fp32, kRelaxedMathOption);
  const SummationTable table = measure_summation(catalog, test::device(), relaxed, options);
  INFO(table.why);
  CHECK(table.ok);
  CHECK(table.host_agrees);
  constexpr std::uint64_t kMany = 1 << 25;
  CHECK(entry(table, "1", 1 << 20, "naive").error == 0);
  CHECK(entry(table, "1", kMany, "naive").error == 0.5);
  CHECK(entry(table, "1", 2 * kMany, "naive").error == 0.75);
  CHECK(entry(table, "1", kMany, "neumaier").error == 0);  // 2^24 in each of its words
  CHECK(entry(table, "1", 2 * kMany, "neumaier").error == 0.5);
  CHECK(entry(table, "0.1", kMany, "naive").error > 0.3);
  CHECK(entry(table, "0.1", 1 << 20, "naive").error == Approx(9.86e-3).epsilon(1e-3));
  CHECK(entry(table, "0.1", 1 << 20, "neumaier").error == Approx(6.67e-5).epsilon(1e-3));
  CHECK(entry(table, "0.1", kMany, "neumaier").error > 1e-2);
  CHECK(entry(table, "1", 2 * kMany, "double-float").error == 0);
  for (const SummationRow& row : table.rows) {
    for (const SummationEntry& e : row.entries) {
      INFO(row.terms << " " << row.n_per_lane << " " << e.sum);
      if (e.sum != "naive" && e.sum != "neumaier") CHECK(e.error <= 2e-8 * row.kappa);
    }
    CHECK(row.entries.size() >= (row.n_per_lane >= kMany ? 5 : test::catalog().sums.size()));
  }
  // Relaxed math leaves of a compensated sum the naive one.
  for (const RelaxedSum& sum : table.relaxed) {
    INFO(sum.sum);
    if (!sum.compensated) continue;
    CHECK(sum.changed);
    CHECK(sum.relaxed_error == entry(table, "0.1", 1 << 20, "naive").error);
  }
  // Without the self-test's word the same table is not all right.
  EftResult silent = relaxed;
  for (EftTest& test : silent.tests) test.passed = true;
  options.constants = {12};
  CHECK_FALSE(measure_summation(catalog, test::device(), silent, options).ok);
}

TEST_CASE("launch shapes change no sum, block lengths none that is order-free", "[device]") {
  InvarianceOptions options;
  options.n = 1 << 14;
  options.log2_blocks = {6, 10, 14};
  const Invariance result =
      measure_invariance(with_terms(test::catalog()), test::device(), options);
  INFO(result.why);
  CHECK(result.ok);
  CHECK(result.shapes >= 24);
  CHECK(result.rows.size() == test::catalog().sums.size());
  for (const InvarianceRow& row : result.rows) {
    INFO(row.sum);
    CHECK(row.most_of_one_block == 1);
    CHECK((row.distinct == 1 || !row.order_free));
    // The data can tell: naive sums depend on the block length.
    if (row.sum == "naive") CHECK(row.distinct == 3);
    if (row.sum == "naive") CHECK(row.spread > 1e-9);
  }
}

TEST_CASE("every index is used once, for any launch split and around 2^31, 2^32 and 2^63",
          "[device]") {
  const IndexChecks result = check_indices(with_indices(test::catalog()), test::device());
  INFO(result.why);
  CHECK(result.ok);
  CHECK(result.checks.size() >= 48);
  for (const IndexRangeCheck& check : result.checks) CHECK(check.ok());
}

TEST_CASE("checksums of indices on the host are those of a plain loop, also beyond 2^64",
          "[unit]") {
  for (const std::uint64_t first : {std::uint64_t{0}, std::uint64_t{5},
                                    (std::uint64_t{1} << 32) - 7, (std::uint64_t{1} << 63) - 3}) {
    IndexSums direct;
    for (std::uint64_t i = first; i < first + 1000; ++i) {
      ++direct.count;
      direct.total += i;
      direct.squares += i * i;
      direct.mixed ^= index_mix(i);
    }
    CHECK(host_index_sums(first, first + 1000) == direct);
  }
  // A mix of few bits would not notice two indices that are exchanged for two others.
  CHECK(index_mix(0) == 0);
  std::uint64_t bits = 0;
  for (std::uint64_t i = 1; i < 64; ++i) bits |= index_mix(i);
  CHECK(bits == UINT64_MAX);
}

TEST_CASE("strict options keep denormals; -cl-denorms-are-zero does not on PoCL, in fp64 neither",
          "[device]") {
  const DenormalChecks result = check_denormals(test::device());
  INFO(result.why);
  CHECK(result.ok);
  CHECK(result.results.size() == 6);
  for (const DenormalResult& one : result.results) {
    INFO(one.options << " " << precision_name(one.precision));
    if (one.options.empty()) CHECK_FALSE(one.flushed());
    if (one.options == "-cl-denorms-are-zero") CHECK(one.product_flushed);
    if (one.options == "-cl-denorms-are-zero") CHECK(one.compared_as_zero);
  }
  CHECK(result.fp_config_fp64.find("DENORM") != std::string::npos);
}
