// Tables of the Kronecker family (kernels/points/kronecker.cl): steps, lane offsets and shifts as
// 64-bit fractions.
#include "points/kronecker.hpp"

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/cpp_int.hpp>

#include "catalog/lanes.hpp"
#include "points/halton.hpp"
#include "points/tables.hpp"

namespace koksma {
namespace {

constexpr std::uint32_t kKroneckerHeader = 4;

// The fractional part of sqrt(p), rounded down to 64 bits.
std::uint64_t root_fraction(std::uint32_t p) {
  using boost::multiprecision::cpp_int;
  const cpp_int root = boost::multiprecision::sqrt(cpp_int(p) << 128);
  return static_cast<std::uint64_t>(root & UINT64_MAX);
}

// phi_d^-j, j = 1 … d: phi_d > 1 solves x^(d+1) = x + 1 (Roberts 2018).
std::vector<std::uint64_t> golden_fractions(std::uint32_t dim) {
  using Real = boost::multiprecision::cpp_bin_float_50;
  // Newton's method from above (x^(d+1) = x + 1 < 3), where the function is convex: a few steps,
  // then rounding.
  Real x = boost::multiprecision::pow(Real(3), Real(1) / (dim + 1));
  for (int i = 0; i < 20; ++i) {
    const Real power = boost::multiprecision::pow(x, dim);
    x -= (power * x - x - 1) / ((dim + 1) * power - 1);
  }
  std::vector<std::uint64_t> result;
  Real alpha = 1;
  for (std::uint32_t j = 0; j < dim; ++j) {
    alpha /= x;
    result.push_back(static_cast<std::uint64_t>(boost::multiprecision::ldexp(alpha, 64)));
  }
  return result;
}

}  // namespace

std::vector<std::uint64_t> kronecker_fractions(const std::string& kind, std::uint32_t dim) {
  if (kind == "generalised-golden-ratio") return golden_fractions(dim);
  std::vector<std::uint64_t> result;
  for (const std::uint32_t p : first_primes(dim)) result.push_back(root_fraction(p));
  return result;
}

PointTable build_kronecker(const PointRequest& request) {
  const std::vector<std::uint64_t> alpha =
      in_draw_order(request, kronecker_fractions(request.options.at("alpha"), request.dim));
  const bool shifted = request.options.at("randomize") == "shift";
  const std::uint64_t lanes = kKroneckerHeader + request.dim;
  std::vector<std::uint64_t> fractions{kKroneckerHeader, lanes,
                                       lanes + std::uint64_t{kLanes} * request.dim, 0};
  for (const std::uint64_t a : alpha) fractions.push_back(kLanes * a);
  for (const std::uint64_t a : alpha)
    for (std::uint32_t lane = 0; lane < kLanes; ++lane) fractions.push_back(lane * a);
  for (std::uint32_t r = 0; r < request.replicates; ++r)
    for (std::uint32_t d = 0; d < request.dim; ++d)
      fractions.push_back(
          shifted ? random_pair(request.seed, 0, r, RandomPurpose::lattice_shift, d).first : 0);

  PointTable table;
  if (request.fp64) {
    table.words = std::move(fractions);
    return table;
  }
  for (const std::uint64_t fraction : fractions) {
    table.words.push_back(fraction & UINT32_MAX);
    table.words.push_back(fraction >> 32);
  }
  return table;
}

}  // namespace koksma
