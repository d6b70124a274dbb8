#include "points/grids.hpp"

#include <cmath>

namespace koksma {

std::uint32_t cube_side(std::uint64_t n, std::uint32_t dim) {
  const auto fits = [&](std::uint64_t m) {
    std::uint64_t power = 1;
    for (std::uint32_t j = 0; j < dim; ++j) {
      power *= m;
      if (power > n) return false;
    }
    return true;
  };
  auto m = static_cast<std::uint64_t>(std::llround(std::pow(static_cast<double>(n), 1.0 / dim)));
  // The power function is off by far less than one.
  if (!fits(m)) --m;
  return static_cast<std::uint32_t>(m);
}

Grid nearest_square(std::uint64_t n) {
  auto a = static_cast<std::uint64_t>(std::sqrt(static_cast<double>(n)));
  while (n % a != 0) --a;
  return {static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(n / a)};
}

void append_bijection(std::vector<std::uint64_t>& words, const PointRequest& request,
                      std::uint32_t replicate, std::uint32_t dimension, std::uint32_t which) {
  const RandomPair key =
      random_pair(request.seed, which, replicate, RandomPurpose::index_permutation, dimension);
  words.push_back(key.first >> 32);
  words.push_back((key.second >> 32) | 1);
}

}  // namespace koksma
