// Excess kurtosis of f: which estimates are not believed, over several seeds, and what entries
// state.
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <vector>

#include "estimate/kurtosis.hpp"

namespace koksma {
namespace {

using Catch::Matchers::Contains;

constexpr int kSeeds = 64;
constexpr std::size_t kSize = 4096;

std::vector<double> draw(std::uint64_t seed, const std::function<double(std::mt19937_64&)>& one) {
  std::mt19937_64 engine(seed);
  std::vector<double> values(kSize);
  for (double& y : values) y = one(engine);
  return values;
}

// Of how many seeds the estimate is not believed.
int unbounded(const std::function<double(std::mt19937_64&)>& one,
              std::optional<double> variance = std::nullopt) {
  int count = 0;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    const Kurtosis kurtosis =
        estimate_kurtosis(draw(static_cast<std::uint64_t>(seed), one), variance);
    CHECK(kurtosis.excess.has_value() == kurtosis.unbounded.empty());
    count += kurtosis.unbounded.empty() ? 0 : 1;
  }
  return count;
}

double lognormal(std::mt19937_64& engine, double sigma) {
  return std::lognormal_distribution<double>(0, sigma)(engine);
}

// k ones among zeros.
std::vector<double> rare(std::size_t k) {
  std::vector<double> values(kSize, 0.0);
  for (std::size_t i = 0; i < k; ++i) values[i * 7] = 1;
  return values;
}

}  // namespace

TEST_CASE("lognormal values are caught from sigma = 2.5 on, light tails are believed",
          "[unit][estimate]") {
  for (const double sigma : {2.5, 3.0, 4.0, 6.0}) {
    const auto one = [sigma](auto& engine) { return lognormal(engine, sigma); };
    CHECK(unbounded(one, std::exp(sigma * sigma) * std::expm1(sigma * sigma)) == kSeeds);
    // The values alone miss fewer than 1 in 100.
    CHECK(unbounded(one) >= kSeeds - 3);
  }
  CHECK(unbounded([](auto& engine) { return std::normal_distribution<double>()(engine); }) == 0);
  CHECK(unbounded([](auto& engine) { return std::uniform_real_distribution<double>()(engine); }) ==
        0);
  // Fixed seeds; of exponential values 4 in 1000 have a largest one that rules.
  CHECK(unbounded([](auto& engine) { return std::exponential_distribution<double>()(engine); }) <
        4);
}

TEST_CASE("a believed estimate is the fourth moment over the squared second, less 3",
          "[unit][estimate]") {
  std::vector<double> values;
  for (int i = 0; i < 256; ++i) values.push_back(i % 2 == 0 ? 1e200 : -1e200);
  CHECK(*estimate_kurtosis(values, std::nullopt).excess == Approx(-2));
  // Frequency p of ones: 1 / (p (1 - p)) - 6.
  const double p = 41.0 / kSize;
  CHECK(*estimate_kurtosis(rare(41), std::nullopt).excess == Approx(1 / (p * (1 - p)) - 6));
}

TEST_CASE("fewer than 20 values do not tell the frequency of a rare event", "[unit][estimate]") {
  CHECK_FALSE(estimate_kurtosis(rare(19), std::nullopt).excess);
  CHECK(estimate_kurtosis(rare(22), std::nullopt).excess);
  CHECK_THAT(estimate_kurtosis(rare(0), std::nullopt).unbounded, Contains("all alike"));
  CHECK_THAT(estimate_kurtosis(rare(0), 0.1).unbounded, Contains("all alike"));
  CHECK(estimate_kurtosis(rare(0), 0.0).unbounded.empty());
}

TEST_CASE("values that miss most of the variance do not tell the kurtosis", "[unit][estimate]") {
  const auto values =
      draw(1, [](auto& engine) { return std::normal_distribution<double>()(engine); });
  CHECK(estimate_kurtosis(values, 1.0).excess);
  CHECK(estimate_kurtosis(values, 0.1).excess);
  CHECK_THAT(estimate_kurtosis(values, 2.5).unbounded, Contains("less than half"));
}

TEST_CASE("of few or non-finite values nothing is known", "[unit][estimate]") {
  std::vector<double> values(255, 0.0);
  values[0] = 1;
  for (int i = 0; i < 2; ++i) {
    const Kurtosis kurtosis = estimate_kurtosis(values, std::nullopt);
    CHECK_FALSE(kurtosis.excess);
    CHECK(kurtosis.unbounded.empty());
    values.resize(kSize, std::numeric_limits<double>::infinity());
  }
}

TEST_CASE("entries state the kurtosis of an indicator, or that there is none", "[unit][estimate]") {
  Integrand f;
  ExactValues exact;
  exact.variance = 0.01;
  CHECK_FALSE(stated_kurtosis(f, exact));
  f.fourth_moment = FourthMoment::indicator;
  CHECK(*stated_kurtosis(f, exact)->excess == Approx(94));
  exact.variance.reset();
  CHECK_FALSE(stated_kurtosis(f, exact));
  f.fourth_moment = FourthMoment::unknown;
  CHECK_FALSE(stated_kurtosis(f, exact)->excess);
  CHECK_THAT(stated_kurtosis(f, exact)->unbounded, Contains("infinite or unknown"));
}

}  // namespace koksma
