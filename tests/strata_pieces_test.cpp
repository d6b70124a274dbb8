// The pieces under the stratified samplers by themselves: coordinates inside strata
// (parts/strata.cl), the (0,2)-sequence's second coordinate (padded-net.cl), sides of grids
// (harness/points/grids.cpp).
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "catalog/embedded.hpp"
#include "points/grids.hpp"
#include "points/matrices.hpp"
#include "tests/numbers.hpp"
#include "tests/support.hpp"

using namespace koksma;
using koksma::test::stratum;

namespace {

// A kernel of a test's own on top of pieces, at 16 lanes.
cl::Kernel kernel_of(bool fp64, const std::vector<const char*>& pieces, const char* body) {
  std::string text = "#define KOKSMA_LANES_PER_ITEM 16\n#define KOKSMA_DIM 2\n";
  text += "#define KOKSMA_CENTRED 1\n#define KOKSMA_FP64 ";
  text += fp64 ? "1\n" : "0\n";
  text += embedded_text("kernels/prelude.cl");
  for (const char* path : pieces) text += embedded_text(path);
  text += body;
  return {test::device().build({"a test's kernel", text, "-cl-std=CL1.2 -w"}).program, "run"};
}

void run_kernel(const cl::Kernel& kernel, std::size_t items) {
  test::device().queue().enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(items),
                                              cl::NDRange(1));
}

template <typename Value>
std::vector<Value> read_back(const cl::Buffer& buffer, std::size_t count) {
  std::vector<Value> values(count);
  test::device().queue().enqueueReadBuffer(buffer, CL_TRUE, 0, count * sizeof(Value),
                                           values.data());
  return values;
}

struct Placed {
  std::vector<std::uint64_t> words;
  std::vector<double> x;
};

// What strata.cl makes of 16 cells and jitters for each n.
Placed place(bool fp64, const std::vector<std::uint32_t>& sizes,
             const std::vector<std::uint32_t>& cells, const std::vector<std::uint64_t>& u) {
  cl::Kernel kernel =
      kernel_of(fp64, {"kernels/points/parts/philox.cl", "kernels/points/parts/strata.cl"}, R"(
__kernel void run(__global const uint *n, __global const uint *cells, __global const word *u, __global word *words,
                  __global scalar *out) {
  const size_t i = get_global_id(0) * KOKSMA_LANES_PER_ITEM;
  const strata s = strata_of(n[get_global_id(0)]);
  const words32 cell = load_lanes(cells + i);
  store_lanes(stratum_word(cell, load_lanes(u + i), s), words + i);
  store_lanes(in_stratum(cell, load_lanes(u + i), s), out + i);
})");
  Device& device = test::device();
  const std::vector<std::uint32_t> narrow(u.begin(), u.end());
  const std::size_t size = fp64 ? 8 : 4, count = u.size();
  const cl::Buffer buffers[] = {
      device.upload(sizes.data(), sizes.size() * 4), device.upload(cells.data(), count * 4),
      fp64 ? device.upload(u.data(), count * 8) : device.upload(narrow.data(), count * 4),
      device.allocate(count * size), device.allocate(count * size)};
  for (cl_uint arg = 0; arg < 5; ++arg) kernel.setArg(arg, buffers[arg]);
  run_kernel(kernel, sizes.size());
  if (fp64)
    return {read_back<std::uint64_t>(buffers[3], count), read_back<double>(buffers[4], count)};
  const auto words = read_back<std::uint32_t>(buffers[3], count);
  const auto x = read_back<float>(buffers[4], count);
  return {{words.begin(), words.end()}, {x.begin(), x.end()}};
}

}  // namespace

TEST_CASE(
    "a coordinate of a stratum is inside it, on the grid and the exact quotient's, for many n and "
    "the extremes of the jitter",
    "[device]") {
  std::vector<std::uint32_t> sizes;
  for (std::uint32_t n = 1; n <= 300; ++n) sizes.push_back(n);
  for (std::uint32_t k = 0; k < 2000; ++k) {
    const std::uint64_t random = random_pair(1, k, 0, RandomPurpose::points, 0).first;
    sizes.push_back(1 + (static_cast<std::uint32_t>(random) >> (2 + random % 29)));
  }
  for (std::uint32_t k = 9; k <= 30; ++k)
    for (const std::uint32_t n : {(1U << k) - 1, 1U << k}) sizes.push_back(n);
  sizes.push_back(715837530);
  for (const bool fp64 : {false, true}) {
    const std::uint64_t all = fp64 ? ~0ULL : 0xFFFFFFFFULL;
    std::vector<std::uint32_t> cells;
    std::vector<std::uint64_t> u;
    for (const std::uint32_t n : sizes) {
      for (std::uint32_t lane = 0; lane < 16; ++lane) {
        const RandomPair random = random_pair(2, u.size(), 0, RandomPurpose::points, 0);
        const std::uint32_t extremes[] = {0, n - 1, n / 2,
                                          static_cast<std::uint32_t>(random.first % n)};
        cells.push_back(extremes[lane / 4]);
        u.push_back(lane % 4 == 0 ? 0 : lane % 4 == 1 ? all : random.second & all);
      }
    }
    // The furthest that the division's estimate falls short, by 3 (found by search).
    std::fill(cells.end() - 16, cells.end(), 715823761);
    std::fill(u.end() - 16, u.end(), all);
    const Placed placed = place(fp64, sizes, cells, u);
    for (std::size_t i = 0; i < u.size(); ++i) {
      const std::uint32_t n = sizes[i / 16];
      const double x = placed.x[i];
      const unsigned __int128 dividend =
          (static_cast<unsigned __int128>(cells[i]) << (fp64 ? 64 : 32)) + u[i];
      INFO("fp64 " << fp64 << " n = " << n << " cell " << cells[i] << " u " << u[i]);
      REQUIRE(placed.words[i] == static_cast<std::uint64_t>(dividend / n));
      REQUIRE((x > 0 && x < 1));
      REQUIRE(std::fmod(std::ldexp(x, fp64 ? 53 : 24), 2) == 1);
      if (fp64 || n <= 1U << 23) REQUIRE(stratum(x, n) == cells[i]);
    }
  }
}

TEST_CASE("the second coordinate of padded-net is the second dimension of Sobol', bit-reversed",
          "[device]") {
  cl::Kernel kernel = kernel_of(true,
                                {"kernels/points/parts/philox.cl", "kernels/points/parts/owen.cl",
                                 "kernels/points/parts/permute.cl", "kernels/points/padded-net.cl"},
                                R"(
__kernel void run(__global const word *indices, __global word *out) {
  const size_t i = get_global_id(0) * KOKSMA_LANES_PER_ITEM;
  store_lanes(reverse_bits(pascal_times(load_lanes(indices + i))), out + i);
})");
  const GeneratingMatrices m = sobol_matrices(2, 32);
  std::vector<std::uint64_t> indices;
  for (std::uint64_t i = 0; i < 1024; ++i) indices.push_back(i);
  for (std::uint64_t k = 0; k < 1024; ++k)
    indices.push_back(random_pair(3, k, 0, RandomPurpose::points, 0).first >> 32);
  Device& device = test::device();
  const cl::Buffer in = device.upload(indices.data(), indices.size() * 8);
  const cl::Buffer out = device.allocate(indices.size() * 8);
  kernel.setArg(0, in);
  kernel.setArg(1, out);
  run_kernel(kernel, indices.size() / 16);
  const auto drawn = read_back<std::uint64_t>(out, indices.size());
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
