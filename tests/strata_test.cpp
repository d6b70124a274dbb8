// Stratified points keep what their catalog entries declare: one point per stratum, row or cell, in
// exact arithmetic, at many N, in both precisions and for every replicate.
#include <algorithm>
#include <bit>
#include <catch2/catch.hpp>
#include <cmath>
#include <set>

#include "catalog/embedded.hpp"
#include "catalog/sizes.hpp"
#include "points/grids.hpp"
#include "points/sobol.hpp"
#include "tests/support.hpp"

using namespace koksma;

namespace {

constexpr Precision kPrecisions[] = {Precision::fp32, Precision::fp64};

bool has_property(const Sampler& s, const char* property) {
  return std::find(s.properties.begin(), s.properties.end(), property) != s.properties.end();
}

// floor(x n) for x = k 2^-53, without rounding.
std::uint64_t stratum(double x, std::uint64_t n) {
  const auto k = static_cast<std::uint64_t>(std::ldexp(x, 53));
  return static_cast<std::uint64_t>(static_cast<unsigned __int128>(k) * n >> 53);
}

// The different sizes of a sampler next to a list of sizes, powers of two and others.
std::set<std::uint64_t> sizes_of(const Sampler& s, std::uint32_t dim) {
  std::set<std::uint64_t> sizes;
  for (const std::uint64_t n : {1U, 2U, 3U, 5U, 12U, 16U, 33U, 100U, 243U, 1000U, 1024U, 4999U})
    sizes.insert(test::admitted_size(s, dim, n));
  return sizes;
}

struct Set {
  std::uint64_t n;
  std::vector<double> x;  // [point][dimension]
};

// Calls check(set) for every size, precision and, of randomized sets, two replicates.
template <typename Check>
void for_all_sets(const Sampler& s, std::uint32_t dim, const Check& check) {
  for (const Precision precision : kPrecisions) {
    for (const std::uint64_t n : sizes_of(s, dim)) {
      for (const std::uint32_t r :
           s.replicable ? std::vector<std::uint32_t>{0, 3} : std::vector<std::uint32_t>{0}) {
        INFO(s.name << " d = " << dim << " N = " << n << " replicate " << r << " "
                    << precision_name(precision));
        check(Set{n, test::points({.sampler = s.name,
                                   .dim = dim,
                                   .precision = precision,
                                   .count = n,
                                   .replicate = r,
                                   .n = n})});
      }
    }
  }
}

// The numbers are 0 ... n-1 in some order.
bool all_taken_once(const std::vector<std::uint64_t>& numbers, std::uint64_t n) {
  std::vector<bool> taken(n, false);
  for (const std::uint64_t k : numbers) {
    if (k >= n || taken[k]) return false;
    taken[k] = true;
  }
  return numbers.size() == n;
}

bool one_per_row(const Set& set, std::uint32_t dim, std::uint32_t d) {
  std::vector<std::uint64_t> rows;
  for (std::size_t i = 0; i < set.n; ++i) rows.push_back(stratum(set.x[i * dim + d], set.n));
  return all_taken_once(rows, set.n);
}

}  // namespace

TEST_CASE("one-per-stratum: each of the m^d cells of the grid holds one point", "[device]") {
  std::size_t found = 0;
  for (const Sampler& s : test::catalog().samplers) {
    if (!has_property(s, "one-per-stratum")) continue;
    ++found;
    for (const std::uint32_t dim : {1U, 2U, 3U}) {
      for_all_sets(s, dim, [&](const Set& set) {
        const auto m = static_cast<std::uint64_t>(
            std::llround(std::pow(static_cast<double>(set.n), 1.0 / dim)));
        std::vector<std::uint64_t> cells;
        for (std::size_t i = 0; i < set.n; ++i) {
          std::uint64_t cell = 0;
          for (std::uint32_t d = dim; d-- > 0;) cell = cell * m + stratum(set.x[i * dim + d], m);
          cells.push_back(cell);
        }
        REQUIRE(all_taken_once(cells, set.n));
        // Deterministic cells come in the order of their numbers, dimension 0 fastest.
        REQUIRE((s.replicable || std::is_sorted(cells.begin(), cells.end())));
      });
    }
  }
  CHECK(found >= 2);
}

TEST_CASE("one-per-row: every coordinate has one point in each of N rows", "[device]") {
  std::size_t found = 0;
  for (const Sampler& s : test::catalog().samplers) {
    if (!has_property(s, "one-per-row")) continue;
    ++found;
    for_all_sets(s, 5, [&](const Set& set) {
      for (std::uint32_t d = 0; d < 5; ++d) REQUIRE(one_per_row(set, 5, d));
    });
  }
  CHECK(found >= 4);
}

TEST_CASE(
    "one-per-cell-2d: each pair of dimensions has one point in each cell of the grid nearest to a "
    "square, an odd last dimension one in each of N rows",
    "[device]") {
  std::size_t found = 0;
  for (const Sampler& s : test::catalog().samplers) {
    if (!has_property(s, "one-per-cell-2d")) continue;
    ++found;
    for_all_sets(s, 5, [&](const Set& set) {
      std::uint64_t a = 1;
      for (std::uint64_t k = 1; k * k <= set.n; ++k)
        if (set.n % k == 0) a = k;
      const std::uint64_t b = set.n / a;
      for (const std::uint32_t d : {0U, 2U}) {
        std::vector<std::uint64_t> cells;
        for (std::size_t i = 0; i < set.n; ++i)
          cells.push_back(stratum(set.x[i * 5 + d], a) * b + stratum(set.x[i * 5 + d + 1], b));
        REQUIRE(all_taken_once(cells, set.n));
      }
      REQUIRE(one_per_row(set, 5, 4));
    });
  }
  CHECK(found >= 4);
}

TEST_CASE("no-duplicates: all points of a set differ", "[device]") {
  for (const Sampler& s : test::catalog().samplers) {
    if (!has_property(s, "no-duplicates")) continue;
    // Programs of the tests above.
    const std::uint32_t dim = has_property(s, "one-per-stratum") ? 3 : 5;
    for_all_sets(s, dim, [&](const Set& set) {
      std::set<std::vector<double>> seen;
      for (auto x = set.x.begin(); x != set.x.end(); x += dim) seen.emplace(x, x + dim);
      REQUIRE(seen.size() == set.n);
    });
  }
}

TEST_CASE(
    "net-per-pair: in every pair of dimensions, all elementary intervals of N points hold one",
    "[device]") {
  std::size_t found = 0;
  for (const Sampler& s : test::catalog().samplers) {
    if (!has_property(s, "net-per-pair")) continue;
    ++found;
    for_all_sets(s, 5, [&](const Set& set) {
      const auto m = static_cast<unsigned>(std::bit_width(set.n) - 1);
      for (const std::uint32_t d : {0U, 2U}) {
        for (unsigned q = 0; q <= m; ++q) {
          std::vector<std::uint64_t> boxes;
          for (std::size_t i = 0; i < set.n; ++i)
            boxes.push_back(stratum(set.x[i * 5 + d], 1ULL << q) << (m - q) |
                            stratum(set.x[i * 5 + d + 1], 1ULL << (m - q)));
          REQUIRE(all_taken_once(boxes, set.n));
        }
      }
    });
  }
  CHECK(found >= 1);
}

TEST_CASE(
    "correlated-substrata: all columns share one permutation of their substrata; multi-jittered "
    "points without it have another in each",
    "[device]") {
  std::size_t shared = 0, own = 0;
  const std::uint64_t a = 16, n = a * a;
  for (const Sampler& s : test::catalog().samplers) {
    if (s.family != "multijitter") continue;
    const auto x = test::points({.sampler = s.name, .dim = 5, .count = n, .n = n});
    for (const std::size_t d : {0UL, 1UL, 2UL, 3UL}) {
      std::set<std::vector<std::uint64_t>> permutations;
      std::vector<std::vector<std::uint64_t>> lines(a, std::vector<std::uint64_t>(a));
      for (std::size_t i = 0; i < n; ++i)
        lines[stratum(x[5 * i + d], a)][stratum(x[5 * i + (d ^ 1)], a)] =
            stratum(x[5 * i + d], n) % a;
      permutations.insert(lines.begin(), lines.end());
      INFO(s.name << " dimension " << d);
      CHECK(permutations.size() == (has_property(s, "correlated-substrata") ? 1 : a));
    }
    ++(has_property(s, "correlated-substrata") ? shared : own);
  }
  CHECK(shared == 1);
  CHECK(own == 1);
}

TEST_CASE("the largest set of a sampler can be drawn at its end, in any blocks", "[device]") {
  std::size_t found = 0;
  for (const Sampler& s : test::catalog().samplers) {
    if (!has_property(s, "no-duplicates") || s.extensible) continue;
    ++found;
    const std::uint32_t dim = has_property(s, "one-per-stratum") ? 3 : 5;
    const std::uint64_t n = nearest_sizes(s, dim, 1ULL << s.max_log2_n).below.value();
    test::PointsSpec spec{.sampler = s.name, .dim = dim};
    spec.start = n - 100;
    spec.count = 100;
    spec.n = n;
    const auto x = test::points(spec);
    spec.log2_block = 4;
    INFO(s.name << " N = " << n);
    REQUIRE(x == test::points(spec));
    CHECK(n > 1ULL << 29);
    std::set<std::vector<double>> seen;
    for (auto point = x.begin(); point != x.end(); point += dim) seen.emplace(point, point + dim);
    CHECK(seen.size() == 100);
    for (std::uint32_t d = 0; d < dim && has_property(s, "one-per-row"); ++d) {
      std::set<std::uint64_t> rows;
      for (std::size_t i = 0; i < 100; ++i) rows.insert(stratum(x[i * dim + d], n));
      CHECK(rows.size() == 100);
    }
  }
  CHECK(found >= 7);
}

TEST_CASE("a regular grid has its cells' centres, cut off to the coordinate's bits", "[device]") {
  for (const Sampler& s : test::catalog().samplers) {
    if (!has_property(s, "one-per-stratum") || s.replicable) continue;
    for (const Precision precision : kPrecisions) {
      const int bits = precision == Precision::fp32 ? 23 : 52;
      for (const std::uint64_t m : {1U, 2U, 3U, 7U, 10U, 64U, 100U}) {
        const auto x = test::points(
            {.sampler = s.name, .dim = 2, .precision = precision, .count = m * m, .n = m * m});
        for (std::size_t i = 0; i < x.size(); ++i) {
          const std::uint64_t cell = i % 2 == 0 ? i / 2 % m : i / 2 / m;
          const auto units = static_cast<std::uint64_t>(
              (static_cast<unsigned __int128>(2 * cell + 1) << bits) / (2 * m));
          INFO(s.name << " m = " << m << " value " << i);
          REQUIRE(x[i] == std::ldexp(static_cast<double>(units), -bits));
        }
      }
    }
  }
}

TEST_CASE(
    "fp32 draws the strata of fp64: the same 23 bits where N is a power of two, at most one unit "
    "away elsewhere",
    "[device]") {
  for (const Sampler& s : test::catalog().samplers) {
    if (!has_property(s, "one-per-row") && !has_property(s, "one-per-cell-2d")) continue;
    for (const std::uint64_t n : sizes_of(s, 5)) {
      const auto fine = test::points({.sampler = s.name, .dim = 5, .count = n, .n = n});
      const auto coarse = test::points(
          {.sampler = s.name, .dim = 5, .precision = Precision::fp32, .count = n, .n = n});
      const double allowed = std::has_single_bit(n) ? 0 : 1;
      std::size_t off = 0;
      for (std::size_t i = 0; i < fine.size(); ++i) {
        const double steps =
            std::fabs(std::floor(std::ldexp(fine[i], 23)) - std::floor(std::ldexp(coarse[i], 23)));
        INFO(s.name << " N = " << n << " value " << i);
        REQUIRE(steps <= allowed);
        off += steps > 0;
      }
      // Only where a centre lies across the border: in about N of the grid's 2^23 steps.
      CHECK(off <= 6 + fine.size() * n / (1 << 22));
    }
  }
}

TEST_CASE(
    "a coordinate of a stratum is inside it, on the grid and the exact quotient's, for many n and "
    "the extremes of the jitter",
    "[device]") {
  // strata.cl through a kernel of this test.
  const std::string body = R"(
__kernel void place(__global const uint *n, __global const uint *cells, __global const word *u, __global word *words,
                    __global scalar *out) {
  const size_t i = get_global_id(0) * KOKSMA_LANES_PER_ITEM;
  const strata s = strata_of(n[get_global_id(0)]);
  const words32 cell = load_lanes(cells + i);
  store_lanes(stratum_word(cell, load_lanes(u + i), s), words + i);
  store_lanes(in_stratum(cell, load_lanes(u + i), s), out + i);
})";
  std::vector<std::uint32_t> sizes;
  for (std::uint32_t n = 1; n <= 300; ++n) sizes.push_back(n);
  for (std::uint32_t k = 0; k < 2000; ++k) {
    const auto random = random_pair(1, k, 0, RandomPurpose::points, 0).first;
    sizes.push_back(1 + (static_cast<std::uint32_t>(random) >> (2 + random % 29)));
  }
  for (std::uint32_t k = 9; k <= 30; ++k)
    for (const std::uint32_t n : {(1U << k) - 1, 1U << k}) sizes.push_back(n);
  for (const bool fp64 : {false, true}) {
    const std::uint64_t all = fp64 ? ~0ULL : 0xFFFFFFFFULL;
    std::vector<std::uint32_t> cells;
    std::vector<std::uint64_t> u;
    for (const std::uint32_t n : sizes) {
      for (std::uint32_t lane = 0; lane < 16; ++lane) {
        const auto random = random_pair(2, u.size(), 0, RandomPurpose::points, 0);
        cells.push_back(lane < 4    ? 0
                        : lane < 8  ? n - 1
                        : lane < 10 ? n / 2
                                    : static_cast<std::uint32_t>(random.first % n));
        u.push_back(lane % 4 == 0 ? 0 : lane % 4 == 1 ? all : random.second & all);
      }
    }
    std::string text =
        "#define KOKSMA_LANES_PER_ITEM 16\n#define KOKSMA_DIM 1\n#define KOKSMA_CENTRED 1\n#define "
        "KOKSMA_FP64 " +
        std::to_string(fp64) + "\n";
    for (const char* path :
         {"kernels/prelude.cl", "kernels/points/parts/philox.cl", "kernels/points/parts/strata.cl"})
      text += embedded_text(path);
    Device& device = test::device();
    cl::Kernel kernel(device.build({"strata", text + body, "-cl-std=CL1.2 -w"}).program, "place");
    const std::vector<std::uint32_t> narrow_u(u.begin(), u.end());
    const std::size_t size = fp64 ? 8 : 4, count = u.size();
    const cl::Buffer buffers[] = {
        device.upload(sizes.data(), sizes.size() * 4), device.upload(cells.data(), count * 4),
        fp64 ? device.upload(u.data(), count * 8) : device.upload(narrow_u.data(), count * 4),
        device.allocate(count * size), device.allocate(count * size)};
    for (cl_uint arg = 0; arg < 5; ++arg) kernel.setArg(arg, buffers[arg]);
    device.queue().enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(sizes.size()),
                                        cl::NDRange(1));
    std::vector<std::uint64_t> words(fp64 ? count : 0);
    std::vector<double> x(fp64 ? count : 0);
    std::vector<std::uint32_t> narrow_words(count);
    std::vector<float> narrow_x(count);
    void* const word_target = fp64 ? static_cast<void*>(words.data()) : narrow_words.data();
    void* const x_target = fp64 ? static_cast<void*>(x.data()) : narrow_x.data();
    device.queue().enqueueReadBuffer(buffers[3], CL_TRUE, 0, count * size, word_target);
    device.queue().enqueueReadBuffer(buffers[4], CL_TRUE, 0, count * size, x_target);
    if (!fp64) words.assign(narrow_words.begin(), narrow_words.end());
    if (!fp64) x.assign(narrow_x.begin(), narrow_x.end());

    for (std::size_t i = 0; i < count; ++i) {
      const std::uint32_t n = sizes[i / 16];
      const unsigned __int128 dividend =
          (static_cast<unsigned __int128>(cells[i]) << (fp64 ? 64 : 32)) + u[i];
      INFO("fp64 " << fp64 << " n = " << n << " cell " << cells[i] << " u " << u[i]);
      REQUIRE(words[i] == static_cast<std::uint64_t>(dividend / n));
      const double units = std::ldexp(x[i], fp64 ? 53 : 24);
      REQUIRE((x[i] > 0 && x[i] < 1));
      REQUIRE(std::fmod(units, 2) == 1);
      if (fp64 || n <= 1U << 23) REQUIRE(stratum(x[i], n) == cells[i]);
    }
  }
}

TEST_CASE("the second coordinate of padded-net is the second dimension of Sobol', bit-reversed",
          "[device]") {
  const std::string body = R"(
__kernel void second(__global const word *indices, __global word *out) {
  out[get_global_id(0)] = reverse_bits(pascal_times(indices[get_global_id(0)]));
})";
  const GeneratingMatrices m = sobol_matrices(2, 32);
  std::vector<std::uint64_t> indices;
  for (std::uint64_t i = 0; i < 1000; ++i) indices.push_back(i);
  for (std::uint64_t k = 0; k < 1000; ++k)
    indices.push_back(random_pair(3, k, 0, RandomPurpose::points, 0).first >> 32);
  std::string text =
      "#define KOKSMA_LANES_PER_ITEM 1\n#define KOKSMA_DIM 2\n#define KOKSMA_CENTRED 1\n#define "
      "KOKSMA_FP64 1\n";
  for (const char* path :
       {"kernels/prelude.cl", "kernels/points/parts/philox.cl", "kernels/points/parts/owen.cl",
        "kernels/points/parts/permute.cl", "kernels/points/padded-net.cl"})
    text += embedded_text(path);
  Device& device = test::device();
  cl::Kernel kernel(device.build({"second", text + body, "-cl-std=CL1.2 -w"}).program, "second");
  const cl::Buffer in = device.upload(indices.data(), indices.size() * 8);
  const cl::Buffer out = device.allocate(indices.size() * 8);
  kernel.setArg(0, in);
  kernel.setArg(1, out);
  device.queue().enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(indices.size()),
                                      cl::NDRange(1));
  std::vector<std::uint64_t> drawn(indices.size());
  device.queue().enqueueReadBuffer(out, CL_TRUE, 0, drawn.size() * 8, drawn.data());
  for (std::size_t i = 0; i < indices.size(); ++i) {
    std::uint64_t expected = 0;
    for (std::size_t k = 0; k < 32; ++k)
      if ((indices[i] >> k & 1) != 0) expected ^= m.words[k * 2 + 1];
    INFO("index " << indices[i]);
    REQUIRE(drawn[i] == expected);
  }
}

TEST_CASE("sides of cubes and grids nearest to a square are exact", "[unit]") {
  for (const std::uint32_t dim : {1U, 2U, 3U, 5U, 10U, 30U})
    for (std::uint64_t m = 1; std::pow(m, dim) <= 0x1p30; m += 1 + m / 64) {
      std::uint64_t n = 1;
      for (std::uint32_t j = 0; j < dim; ++j) n *= m;
      REQUIRE(cube_side(n, dim) == m);
      if (n > 1 && dim > 1) REQUIRE(cube_side(n - 1, dim) == m - 1);
    }
  for (std::uint64_t n = 1; n <= 5000; ++n) {
    const Grid grid = nearest_square(n);
    REQUIRE(std::uint64_t{grid.columns} * grid.rows == n);
    for (std::uint64_t a = grid.columns + 1; a * a <= n; ++a) REQUIRE(n % a != 0);
  }
}
