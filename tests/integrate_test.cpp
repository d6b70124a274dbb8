// The integration kernel: the same bits for every launch shape, any N by mask, indices beyond 2^32,
// sums, moments, faults.
#include <algorithm>
#include <bit>
#include <catch2/catch.hpp>
#include <cmath>

#include "device/prepare.hpp"
#include "error/error.hpp"
#include "estimate/exact_sum.hpp"
#include "estimate/measure.hpp"
#include "tests/support.hpp"

using namespace koksma;
using test::cell;
using test::partial_sums;

namespace {

LaunchShape shape(std::uint32_t lanes, std::uint32_t local = 1,
                  std::optional<std::uint64_t> items = {},
                  std::optional<std::uint32_t> block = {}) {
  return {lanes, local, block, items};
}

// The values f(x_0 … x_{n-1}) of replicate 0: blocks of 16 samples store every value as its own
// partial sum.
std::vector<double> values(const Cell& c, std::uint64_t first_block, std::uint64_t blocks) {
  const Plan plan = make_plan(test::catalog(), c, test::device().facts());
  const ExactValues exact = compute_exact(test::device(), *plan.integrand, c.scene);
  Integrator integrator(test::device(), plan, exact.coefficients);
  std::vector<double> result;
  integrator.run_blocks(c.n.back(), 4, first_block, first_block + blocks, 1, 0.0,
                        [&](std::uint32_t word, std::uint32_t, std::span<const double> p) {
                          if (word == 0) result.insert(result.end(), p.begin(), p.end());
                        });
  return result;
}

// What the kernel leaves in its output when a launch makes `runs` runs of N samples, and behind it
// `guard` doubles that were 7.
std::vector<double> sums_of_runs(const Plan& plan, std::size_t runs, std::size_t guard) {
  Device& device = test::device();
  const std::uint64_t n = plan.cell.n.front();
  const std::uint32_t log2_block = 5;
  const std::uint64_t blocks = n >> log2_block;
  const ExactValues exact = compute_exact(device, *plan.integrand, plan.cell.scene);
  const std::vector<std::byte> table = point_table(device, plan);
  std::vector<double> sums(runs * plan.words() * plan.launched_replicates() * blocks * 16 + guard,
                           7);
  const std::size_t bytes = sums.size() * sizeof(double);
  const cl::Buffer out = device.upload(sums.data(), bytes);
  cl::Kernel kernel(device.build(plan.program).program, "integrate");
  const cl::Buffer points = device.upload(table.data(), table.size()),
                   values = device.upload_reals(plan.cell.scene.parameters, plan.fp64()),
                   coefficients = device.upload_reals(exact.coefficients, plan.fp64());
  cl_uint arg = 0;
  for (const cl::Buffer& buffer : {points, values, coefficients}) kernel.setArg(arg++, buffer);
  for (const cl_ulong value :
       {cl_ulong{0}, cl_ulong{blocks}, cl_ulong{n}, cl_ulong{plan.cell.seed}})
    kernel.setArg(arg++, value);
  for (const cl_uint value : {log2_block, 0U}) kernel.setArg(arg++, value);
  kernel.setArg(arg++, cl_double{0});
  kernel.setArg(arg++, out);
  const std::uint64_t items = blocks * (16 / plan.shape.lanes_per_item),
                      local = plan.shape.local_size;
  device.queue().enqueueNDRangeKernel(
      kernel, cl::NullRange,
      cl::NDRange((items + local - 1) / local * local, plan.launched_replicates(), runs),
      cl::NDRange(local, 1, 1));
  device.queue().enqueueReadBuffer(out, CL_TRUE, 0, bytes, sums.data());
  return sums;
}

}  // namespace

TEST_CASE("the runs of one launch leave the same sums behind each other", "[device]") {
  for (const char* sampler : {"sobol-shift", "random"}) {  // one moment, and two
    const Plan plan = make_plan(test::catalog(), cell("linear-prod:d=3", sampler, 1 << 8, 3),
                                test::device().facts());
    REQUIRE(plan.stores_doubles());
    INFO(sampler);
    const std::size_t guard = 64;
    const std::vector<double> one = sums_of_runs(plan, 1, guard),
                              three = sums_of_runs(plan, 3, guard);
    const auto size = static_cast<std::ptrdiff_t>(one.size() - guard);
    REQUIRE(std::count(one.begin(), one.begin() + size, 7.0) == 0);
    for (int run = 0; run < 3; ++run)
      CHECK(std::equal(one.begin(), one.begin() + size, three.begin() + run * size));
    CHECK(std::count(three.begin() + 3 * size, three.end(), 7.0) ==
          static_cast<std::ptrdiff_t>(guard));
  }
}

TEST_CASE(
    "partial sums are the same bits for 4, 8 and 16 lanes, all work-group sizes and launch splits",
    "[device]") {
  // An integrand with exp: vector math agrees between widths from 4 on.
  for (const Precision precision : {Precision::fp32, Precision::fp64}) {
    for (const char* sampler : {"sobol-owen", "random", "lattice-shift"}) {
      Cell c = cell("genz-gaussian:d=3", sampler, 1 << 12, 3);
      c.precision = precision;
      const auto reference = partial_sums(c, shape(16));
      REQUIRE(reference.size() >= 768);
      for (const auto& other : {shape(4), shape(8), shape(16, 2), shape(16, 16), shape(4, 8),
                                shape(16, 1, 7), shape(16, 1, 1), shape(8, 4, 5)}) {
        INFO(sampler << " " << precision_name(precision) << " lanes " << other.lanes_per_item
                     << " local " << other.local_size);
        REQUIRE(partial_sums(c, other) == reference);
      }
    }
  }
}

TEST_CASE(
    "one lane per work-item gives the same bits too where the entry declares exact operations",
    "[device]") {
  // Of the first few; pieces_test meets them all.
  std::size_t taken = 0;
  for (const Integrand& f : test::catalog().integrands) {
    if (!f.exact_operations || ++taken > 4) continue;
    for (const Precision precision : {Precision::fp32, Precision::fp64}) {
      Cell c = cell(f.name, "sobol-shift", 1 << 10, 2);
      c.precision = precision;
      INFO(f.name << " " << precision_name(precision));
      REQUIRE(partial_sums(c, shape(1)) == partial_sums(c, shape(16)));
      REQUIRE(partial_sums(c, shape(1, 64)) == partial_sums(c, shape(16)));
    }
  }
}

TEST_CASE("the block length is what may change the bits of sums, never the points", "[device]") {
  const Cell c = cell("linear-prod:d=4", "sobol-owen", 1 << 12, 1);
  const auto total = [&](std::uint32_t block) {
    ExactSum sum;
    sum.add(partial_sums(c, shape(16, 1, {}, block)));
    return sum.rounded_quotient(1 << 12);
  };
  for (const std::uint32_t block : {4U, 6U, 10U, 12U})
    CHECK(total(block) == Approx(total(8)).epsilon(1e-15));
}

TEST_CASE("any N is summed exactly as far as N: the last block is masked", "[device]") {
  for (const std::uint64_t n :
       {1ULL, 2ULL, 15ULL, 16ULL, 17ULL, 100ULL, 255ULL, 257ULL, 1000ULL, 4097ULL}) {
    for (const std::uint32_t lanes : {1U, 4U, 16U}) {
      ExactSum direct;
      const auto drawn = test::points({.sampler = "sobol-owen", .dim = 1, .count = n});
      for (const double x : drawn) direct.add(x + 0.5);
      ExactSum sum;
      sum.add(partial_sums(cell(test::kIdentity, "sobol-owen", n), shape(lanes)));
      INFO("N = " << n << " lanes " << lanes);
      CHECK(sum.rounded_quotient(n) == Approx(direct.rounded_quotient(n)).epsilon(1e-15));
    }
  }
}

TEST_CASE("masked lanes add nothing to the second moment either", "[device]") {
  const std::uint64_t n = 37;
  const Cell c = cell(test::kIdentity, "random", n, 1, "mc");
  const auto partials = partial_sums(c, shape(16));  // y0 = 0.25
  ExactSum squares, direct;
  squares.add(std::span(partials).subspan(partials.size() / 2));
  for (const double x : test::points({.sampler = "random", .dim = 1, .count = n}))
    direct.add((x + 0.25) * (x + 0.25));
  CHECK(squares.rounded() == Approx(direct.rounded()).epsilon(1e-14));
}

TEST_CASE("squares of pair means and pair differences are those of the samples, at every width",
          "[device]") {
  constexpr double kCentre = 0.25;  // what partial_sums gives
  for (const Estimator& estimator : test::catalog().estimators) {
    if (!estimator.second_moment.starts_with("pair")) continue;
    const bool means = estimator.second_moment == "pair-means";
    const std::string sampler = means ? "random-antithetic" : "stratified-pairs";
    // Of N = 2 mod 4 the mask ends inside a vector of 4. Strata: N = 2 m^2.
    for (const std::uint64_t n :
         {std::uint64_t{50}, means ? std::uint64_t{70} : std::uint64_t{98}, std::uint64_t{72}}) {
      for (const Precision precision : {Precision::fp32, Precision::fp64}) {
        Cell c = cell("linear-prod:d=2", sampler, n, 1, estimator.name);
        c.precision = precision;
        const auto y = values(c, 0, (n + 15) / 16);
        REQUIRE(y.size() >= n);
        ExactSum direct;
        for (std::size_t i = 0; i < n; ++i) {
          const double term = means ? (y[i] + y[i ^ 1]) / 2 - kCentre : y[i] - y[i ^ 1];
          direct.add(term * term);
        }
        // A pair needs two lanes: one is made 4.
        CHECK(make_plan(test::catalog(), c, test::device().facts(), "", {shape(1)})
                  .shape.lanes_per_item == 4);
        for (const std::uint32_t lanes : {4U, 8U, 16U}) {
          const auto partials = partial_sums(c, shape(lanes));
          ExactSum squares;
          squares.add(std::span(partials).subspan(partials.size() / 2));
          INFO(estimator.name << " " << precision_name(precision) << " lanes " << lanes << " N "
                              << n);
          CHECK(squares.rounded() ==
                Approx(direct.rounded()).epsilon(precision == Precision::fp64 ? 1e-13 : 1e-6));
        }
      }
    }
  }
}

TEST_CASE("what a work-group keeps in private memory is bounded, with pairs of samples too",
          "[unit]") {
  DeviceFacts gpu;
  gpu.is_cpu = false;
  gpu.max_work_group_size = 1024;
  std::size_t kept = 0;
  for (const Integrand& f : test::catalog().integrands) {
    if (!f.all_coordinates) continue;
    // Plans of more dimensions than the entry offers, too.
    for (const std::uint32_t d : {64U, 1024U, 4096U, 16384U, 32768U}) {
      for (const DeviceFacts& facts : {gpu, test::device().facts()}) {
        Cell c = cell(f.name, "random-antithetic", 1 << 10, 1);
        c.scene.dim = d;
        const LaunchShape used = make_plan(test::catalog(), c, facts).shape;
        INFO(f.name << " d = " << d << ", " << used.lanes_per_item << " lanes x "
                    << used.local_size);
        CHECK(used.lanes_per_item >= 4);
        CHECK(std::uint64_t{used.lanes_per_item} * used.local_size * d * 8 <= 1 << 20);
        ++kept;
      }
    }
    Cell c = cell(f.name, "random-antithetic", 1 << 10, 1);
    c.scene.dim = 65536;
    CHECK_THROWS_AS(make_plan(test::catalog(), c, gpu), UnsupportedError);
  }
  CHECK(kept > 0);
}

TEST_CASE("samples at and beyond index 2^32 are those of the points there", "[device]") {
  for (const char* sampler : {"sobol", "sobol-shift", "sobol-lms-shift", "sobol-owen", "random"}) {
    Cell c = cell(test::kIdentity, sampler, 1ULL << 34);
    const std::uint64_t first = (1ULL << 32) - 64;
    const auto drawn = test::points({.sampler = sampler, .dim = 1, .start = first, .count = 128});
    const auto y = values(c, first >> 4, 8);
    REQUIRE(y.size() == 128);
    for (std::size_t i = 0; i < y.size(); ++i) {
      INFO(sampler << " index 2^32 - 64 + " << i);
      REQUIRE(y[i] == drawn[i] + 0.5);
    }
  }
}

TEST_CASE("the first 2^m points of sobol sum to N/2 - 1/2, and a whole net keeps that beyond 2^32",
          "[device]") {
  // Identity on van der Corput points: the error of the mean is -2^(-m-1) exactly (5-numerics 1.8).
  for (const std::uint64_t n : {1ULL << 8, 1ULL << 16, 1ULL << 20}) {
    ExactSum sum;
    sum.add(partial_sums(cell(test::kIdentity, "sobol", n), shape(16)));
    CHECK(sum.rounded_quotient(n) - 1.0 == -0.5 / static_cast<double>(n));
  }
}

TEST_CASE("kahan and double sums hold where the naive fp32 sum drifts", "[device]") {
  // One block of 2^20 samples: 2^16 additions per lane of numbers near 1.
  const auto error_of = [](const char* algorithm) {
    Cell c = cell("linear-prod:d=2,power=0,scale=0.1", "sobol-shift", 1 << 20);
    c.precision = Precision::fp32;
    c.sum = algorithm;
    ExactSum sum;
    sum.add(partial_sums(c, shape(16, 1, {}, 20)));
    return sum.rounded_quotient(1 << 20);
  };
  const double reference = error_of("double");
  CHECK(std::fabs(error_of("naive") - reference) > 2e-8);
  CHECK(std::fabs(error_of("kahan") - reference) < 1e-11);
}

TEST_CASE("every sum of the catalog gives the integral in both precisions", "[device]") {
  for (const SumAlgorithm& sum : test::catalog().sums) {
    for (const Precision precision : {Precision::fp32, Precision::fp64}) {
      Cell c = cell("linear-prod:d=3", "sobol-owen", 1 << 12, 2);
      c.precision = precision;
      c.sum = sum.name;
      const auto partials = partial_sums(c, shape(8));
      const bool fp64 = precision == Precision::fp64;
      const std::size_t size = partials.size() / sum.words(fp64);  // of a word
      ExactSum total;
      for (unsigned word = 0; word < sum.words(fp64); ++word)
        total.add(std::span(partials).subspan(word * size, size), sum.word_exponent(fp64, word));
      INFO(sum.name << " " << precision_name(precision));
      CHECK(total.rounded_quotient(2 << 12) == Approx(1.0).epsilon(1e-4));
    }
  }
}

TEST_CASE(
    "non-finite samples are counted, all of them, and nothing finite is reported in their place",
    "[device]") {
  // Keister at x = 0 takes the cosine of infinity; only the zero point of unrandomized Sobol' lies
  // there.
  Cell c = cell("keister:d=3", "sobol", 1 << 9);
  PreparedCell prepared(test::catalog(), test::device(), test::device(),
                        make_plan(test::catalog(), c, test::device().facts()));
  const Row row = prepared.run_row(1 << 9);
  CHECK(row.nonfinite == 1);
  CHECK_FALSE(row.errors.rmse);
  CHECK_FALSE(row.estimate.value);
}

TEST_CASE("a row is repeated to 20 ms or 5 times and reports median, minimum, spread and count",
          "[device]") {
  PreparedCell prepared(test::catalog(), test::device(), test::device(),
                        make_plan(test::catalog(), cell("linear-prod:d=2", "sobol-owen", 256, 2),
                                  test::device().facts()));
  const Row row = prepared.run_row(256);
  CHECK((row.kernel.count >= 1 && row.kernel.count <= 5));
  CHECK((row.kernel.min > 0 && row.kernel.min <= row.kernel.median));
  CHECK(row.kernel.spread >= 0);
  CHECK(row.wall.median >= row.kernel.min);
}

TEST_CASE("replicates beyond one launch are the replicates of one launch", "[device]") {
  const Cell c = cell("linear-prod:d=2", "sobol-owen", 64, 9);
  CHECK(partial_sums(c, shape(16, 1, 4)) == partial_sums(c, shape(16)));
}

TEST_CASE("a point table larger than the device allocates is refused with its size", "[device]") {
  Plan plan = make_plan(test::catalog(), cell("linear-prod:d=8", "sobol-lms-shift", 1 << 10, 32),
                        test::device().facts());
  const std::size_t bytes = build_point_table(plan).size();
  plan.max_allocation = bytes;
  CHECK(build_point_table(plan).size() == bytes);
  plan.max_allocation = bytes - 1;
  CHECK_THROWS_AS(build_point_table(plan), UnsupportedError);
}
