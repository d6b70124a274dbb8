#include "catalog/sizes.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace koksma {
namespace {

// m^d, or the largest 64-bit number where that overflows.
std::uint64_t saturated_power(std::uint64_t m, std::uint32_t d) {
  std::uint64_t result = 1;
  for (std::uint32_t j = 0; j < d && m > 1; ++j) {
    if (result > UINT64_MAX / m) return UINT64_MAX;
    result *= m;
  }
  return result;
}

// The largest m with m^d <= n.
std::uint64_t integer_root(std::uint64_t n, std::uint32_t d) {
  auto m = static_cast<std::uint64_t>(std::pow(static_cast<double>(n), 1.0 / d));
  while (saturated_power(m + 1, d) <= n) ++m;
  while (m > 1 && saturated_power(m, d) > n) --m;
  return std::max<std::uint64_t>(m, 1);
}

bool is_rectangle(std::uint64_t n) {
  for (std::uint64_t a = integer_root(n, 2); 2 * a * a >= n; --a)
    if (n % a == 0) return true;
  return false;
}

bool has_form(const std::string& form, std::uint32_t dim, std::uint64_t n) {
  if (form == "even") return n % 2 == 0;
  if (form == "power-of-two") return std::has_single_bit(n);
  if (form == "power-of-d") return saturated_power(integer_root(n, dim), dim) == n;
  if (form == "twice-power-of-d") return n % 2 == 0 && has_form("power-of-d", dim, n / 2);
  if (form == "rectangle") return is_rectangle(n);
  return true;
}

// Sizes of a form that are far apart.
NearestSizes far_apart(const std::string& form, std::uint32_t dim, std::uint64_t n) {
  if (form == "power-of-two") return {std::bit_floor(n), std::bit_floor(n) * 2};
  if (form == "twice-power-of-d") {
    const NearestSizes half = far_apart("power-of-d", dim, n / 2);
    return {2 * *half.below, *half.above > UINT64_MAX / 2 ? UINT64_MAX : 2 * *half.above};
  }
  const std::uint64_t m = integer_root(n, dim);
  return {saturated_power(m, dim), saturated_power(m + 1, dim)};
}

}  // namespace

bool admits(const Sampler& sampler, std::uint32_t dim, std::uint64_t n) {
  return has_form(sampler.size_form, dim, n);
}

NearestSizes nearest_sizes(const Sampler& sampler, std::uint32_t dim, std::uint64_t n) {
  const std::string& form = sampler.size_form;
  const std::uint64_t most = std::uint64_t{1} << sampler.max_log2_n;
  NearestSizes nearest{n, n};
  if (!has_form(form, dim, n)) {
    if (form.find("power-of-") != std::string::npos) {
      nearest = far_apart(form, dim, n);
    } else {
      while (*nearest.below > 1 && !has_form(form, dim, *nearest.below)) --*nearest.below;
      while (*nearest.above < most && !has_form(form, dim, *nearest.above)) ++*nearest.above;
    }
  }
  if (!has_form(form, dim, *nearest.below) || *nearest.below > most) nearest.below.reset();
  if (!has_form(form, dim, *nearest.above) || *nearest.above > most) nearest.above.reset();
  return nearest;
}

}  // namespace koksma
