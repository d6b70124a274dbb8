// The table family: what its sets promise, and what their copies, by shift or by nested scrambling,
// keep of it.
#include "points/table.hpp"

#include <Random123/philox.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <complex>
#include <set>

#include "tests/numbers.hpp"
#include "tests/support.hpp"

using namespace koksma;
using koksma::test::circle_distance;
using koksma::test::has_property;
using koksma::test::points;
using koksma::test::word52;

namespace {

// The sampler with a set of `size` points, where its size can be chosen.
std::string with_points(const Sampler& s, const std::string& size) {
  const bool chosen = std::any_of(s.parameters.begin(), s.parameters.end(),
                                  [](const SamplerParameter& p) { return p.name == "points"; });
  return chosen ? s.name + ":points=" + size : s.name;
}

// Samplers of this family whose sets are copied: all but those of a file of the user's.
std::vector<Sampler> copied() {
  std::vector<Sampler> result;
  for (const Sampler& s : test::catalog().samplers)
    if (s.family == "table" && s.replicable) result.push_back(s);
  return result;
}

std::uint64_t set_size(const std::string& sampler) {
  return table_size(test::catalog().sampler(sampler, "test").options);
}

std::uint32_t some_dim(const Sampler& s) { return std::min(s.max_dim, 6U); }

double minimum_distance(const std::vector<double>& xy) {
  double least = INFINITY;
  for (std::size_t i = 0; i < xy.size(); i += 2)
    for (std::size_t j = 0; j < i; j += 2)
      least = std::min(
          least, std::hypot(circle_distance(xy[i], xy[j]), circle_distance(xy[i + 1], xy[j + 1])));
  return least;
}

// |sum of exp(2 pi i (f x + g y))|^2 / N for 0 <= f <= most, |g| <= most, added to `power`.
struct Spectrum {
  std::size_t most;
  std::vector<double> power = std::vector<double>((most + 1) * (2 * most + 1), 0.0);
  double sets = 0;

  void add(const std::vector<double>& xy) {
    const std::size_t n = xy.size() / 2, width = 2 * most + 1;
    std::vector<std::complex<double>> sums(power.size());
    std::vector<std::complex<double>> along_x(most + 1), along_y(width);
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t f = 0; f <= most; ++f)
        along_x[f] = std::polar(1.0, 2 * M_PI * static_cast<double>(f) * xy[2 * i]);
      for (std::size_t g = 0; g < width; ++g)
        along_y[g] = std::polar(
            1.0, 2 * M_PI * (static_cast<double>(g) - static_cast<double>(most)) * xy[2 * i + 1]);
      for (std::size_t f = 0; f <= most; ++f)
        for (std::size_t g = 0; g < width; ++g) sums[f * width + g] += along_x[f] * along_y[g];
    }
    for (std::size_t k = 0; k < sums.size(); ++k)
      power[k] += std::norm(sums[k]) / static_cast<double>(n);
    ++sets;
  }

  // Mean power over frequencies with low < |f| <= high; white noise has 1.
  double mean(double low, double high) const {
    double sum = 0, count = 0;
    for (std::size_t k = 0; k < power.size(); ++k) {
      const std::size_t row = k / (2 * most + 1), column = k % (2 * most + 1);
      const auto f = static_cast<double>(row);
      const double g = static_cast<double>(column) - static_cast<double>(most);
      const double radius = std::hypot(f, g);
      if (radius <= low || radius > high) continue;
      sum += power[k] / sets;
      ++count;
    }
    return sum / count;
  }

  double peak() const {
    double best = 1;
    for (double r = 1; r <= static_cast<double>(most); ++r)
      if (mean(r - 0.5, r + 0.5) > mean(best - 0.5, best + 0.5)) best = r;
    return best;
  }
};

bool is_0m2_net(const std::vector<double>& points, std::uint32_t dim, std::uint32_t pair,
                std::size_t first, unsigned m) {
  for (unsigned q = 0; q <= m; ++q) {
    std::set<std::pair<double, double>> boxes;
    for (std::size_t i = first; i < first + (std::size_t{1} << m); ++i)
      boxes.emplace(std::floor(std::ldexp(points[i * dim + pair], static_cast<int>(q))),
                    std::floor(std::ldexp(points[i * dim + pair + 1], static_cast<int>(m - q))));
    if (boxes.size() != std::size_t{1} << m) return false;
  }
  return true;
}

// The 52-bit words that quartet 0 of purpose 11 holds for a tile (kernels/README.md).
std::array<std::uint64_t, 4> tile_words(std::uint64_t seed, std::uint64_t tile,
                                        std::uint32_t replicate) {
  const auto block = [&](std::uint32_t k) {
    const r123::Philox4x32::ctr_type counter{{static_cast<std::uint32_t>(tile),
                                              static_cast<std::uint32_t>(tile >> 32), replicate,
                                              11U << 24 | k}};
    const r123::Philox4x32::key_type key{
        {static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)}};
    return r123::Philox4x32{}(counter, key);
  };
  const auto high = block(0), low = block(1);
  std::array<std::uint64_t, 4> words{};
  for (std::size_t i = 0; i < 4; ++i) words[i] = (std::uint64_t{high[i]} << 32 | low[i]) >> 12;
  return words;
}

}  // namespace

TEST_CASE("dart throwing keeps 0.7 / sqrt(n) between the first n points, for every n", "[unit]") {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const PlanarSet set = throw_darts(seed, 1024, 0.7);
    REQUIRE(set.size() == 2048);
    double least = INFINITY;
    std::vector<double> xy;
    for (const std::uint64_t word : set) xy.push_back(std::ldexp(static_cast<double>(word), -64));
    for (std::size_t i = 0; i < 2048; i += 2) {
      for (std::size_t j = 0; j < i; j += 2)
        least = std::min(least, std::hypot(circle_distance(xy[i], xy[j]),
                                           circle_distance(xy[i + 1], xy[j + 1])));
      const std::size_t n = i / 2 + 1;
      REQUIRE(least * std::sqrt(static_cast<double>(n)) >= 0.7);
    }
  }
}

TEST_CASE("disk sets keep the distance that they declare, in every copy", "[device]") {
  std::size_t tested = 0;
  for (const Sampler& s : test::catalog().samplers) {
    if (!has_property(s, "minimum-distance")) continue;
    ++tested;
    const std::string name = with_points(s, "1024");
    const std::uint64_t size = set_size(name);
    const double declared = s.options["minimum_distance"];
    for (const std::uint64_t tile : {0U, 1U, 5U}) {
      if (tile > 0 && s.family != "table") continue;  // not a set that is copied
      for (const std::uint32_t r : {0U, 3U}) {
        const double least = minimum_distance(points(
            {.sampler = name, .dim = 2, .start = tile * size, .count = size, .replicate = r}));
        INFO(name << ": " << least * std::sqrt(static_cast<double>(size)));
        CHECK(least * std::sqrt(static_cast<double>(size)) >= declared * (1 - 1e-7));  // 32 bits
      }
    }
  }
  CHECK(tested >= 2);
}

TEST_CASE(
    "the spectrum of blue noise is below 0.2 under a quarter of its peak frequency, over 16 seeds",
    "[device]") {
  // Measured 0.07 to 0.09; with 16 sets the mean over that disk of some 200 frequencies has a
  // relative standard deviation of 2 %: false alarm far below 1e-6.
  std::size_t tested = 0;
  for (const Sampler& s : test::catalog().samplers) {
    if (!has_property(s, "blue-noise")) continue;
    ++tested;
    Spectrum spectrum{48};
    for (std::uint64_t seed = 1; seed <= 16; ++seed)
      spectrum.add(
          points({.sampler = with_points(s, "1024"), .dim = 2, .count = 1024, .seed = seed}));
    const double peak = spectrum.peak(), low = spectrum.mean(0, peak / 4);
    INFO(s.name << ": peak at " << peak << ", power " << low << " below a quarter of it");
    CHECK(std::fabs(peak - 36) < 8);  // 2 / (sqrt(3) mean distance of a triangular lattice) is 34
    CHECK(low < 0.2);
  }
  CHECK(tested >= 3);
  // The measure tells white noise: 1, standard deviation 0.02.
  Spectrum white{48};
  for (std::uint64_t seed = 1; seed <= 16; ++seed)
    white.add(points({.sampler = "random", .dim = 2, .count = 1024, .seed = seed}));
  CHECK(std::fabs(white.mean(0, 9) - 1) < 0.12);
}

TEST_CASE("sets without duplicates have none, nor have their copies", "[device]") {
  for (const Sampler& s : copied()) {
    if (!has_property(s, "no-duplicates")) continue;
    const std::uint64_t count = 2 * set_size(s.name);
    const auto drawn = points({.sampler = s.name, .dim = 2, .count = count});
    std::set<std::pair<double, double>> seen;
    for (std::size_t i = 0; i < drawn.size(); i += 2) seen.emplace(drawn[i], drawn[i + 1]);
    INFO(s.name);
    CHECK(seen.size() == count);
  }
}

TEST_CASE("sample i of a shifted set is point i mod K plus the shift of tile i / K, on 52 bits",
          "[device]") {
  for (const Sampler& s : copied()) {
    if (s.defines.at("KOKSMA_TABLE_TILES") != 1) continue;
    const std::string name = with_points(s, "256");
    const std::uint64_t seed = 0x123456789ABCDEFU, far = std::uint64_t{1} << 40;
    const auto first = points({.sampler = name, .dim = 2, .count = 256, .seed = seed});
    for (const std::uint64_t tile : {std::uint64_t{0}, std::uint64_t{1}, far})
      for (const std::uint32_t r : {0U, 2U}) {
        const auto copy = points({.sampler = name,
                                  .dim = 2,
                                  .start = tile * 256,
                                  .count = 256,
                                  .replicate = r,
                                  .seed = seed});
        const auto origin = tile_words(seed, 0, 0), shift = tile_words(seed, tile, r);
        for (std::size_t i = 0; i < copy.size(); ++i) {
          const std::uint64_t word = word52(first[i]) - origin[i % 2] + shift[i % 2];
          REQUIRE(word52(copy[i]) == (word & ((std::uint64_t{1} << 52) - 1)));
        }
      }
  }
}

TEST_CASE("progressive multi-jittered points fill every elementary interval of every prefix of 2^k",
          "[unit]") {
  for (const std::uint64_t seed : {1U, 2U, 77U}) {
    const PlanarSet set = progressive_multijitter(seed, 4096);
    REQUIRE(set.size() == 8192);
    std::vector<double> xy;
    for (const std::uint64_t word : set)
      xy.push_back(std::ldexp(static_cast<double>(word >> 12), -52));
    for (unsigned m = 0; m <= 12; ++m) REQUIRE(is_0m2_net(xy, 2, 0, 0, m));
  }
}

TEST_CASE(
    "scrambled copies keep the nets: every prefix of 2^k, pair of dimensions, replicate and tile",
    "[device]") {
  std::size_t tested = 0;
  for (const Sampler& s : copied()) {
    if (!has_property(s, "digital-net")) continue;
    ++tested;
    const std::uint64_t size = set_size(s.name);
    for (const Precision precision : {Precision::fp32, Precision::fp64})
      for (const std::uint64_t tile : {0U, 1U})
        for (const std::uint32_t r : {0U, 5U}) {
          const auto drawn = points({.sampler = s.name,
                                     .dim = 6,
                                     .precision = precision,
                                     .start = tile * size,
                                     .count = tile == 0 && r == 0 ? size : 1024,
                                     .replicate = r});
          for (unsigned m = 0; std::size_t{6} << m <= drawn.size(); ++m)
            for (const std::uint32_t pair : {0U, 2U, 4U}) {
              INFO(s.name << " tile " << tile << " replicate " << r << " pair " << pair << " m "
                          << m);
              REQUIRE(is_0m2_net(drawn, 6, pair, 0, m));
            }
        }
  }
  CHECK(tested >= 1);
}

TEST_CASE("pairs of dimensions are associated at random: quadrants across pairs fill evenly",
          "[statistical]") {
  // 1024 points: 256 a quadrant, standard deviation about 8; 8 of them. Fixed seed.
  for (const Sampler& s : copied()) {
    if (s.max_dim < 6) continue;
    for (std::uint32_t r = 0; r < 8; ++r) {
      const auto drawn = points({.sampler = s.name, .dim = 6, .count = 1024, .replicate = r});
      for (std::size_t a = 0; a < 6; ++a)
        for (std::size_t b = a + 1; b < 6; ++b) {
          double count = 0;
          for (std::size_t i = 0; i < drawn.size(); i += 6)
            count += drawn[i + a] < 0.5 && drawn[i + b] < 0.5 ? 1 : 0;
          INFO(s.name << " replicate " << r << " dimensions " << a << ", " << b << ": " << count);
          CHECK(std::fabs(count - 256) <= 64);
        }
    }
  }
}

TEST_CASE(
    "at a fixed index, and at two indices of different tiles, coordinates are uniform and "
    "independent over 10^4 replicates",
    "[statistical]") {
  // chi-squared on 8 x 8 cells, 63 degrees of freedom: above 155 with probability 6e-10, some 200
  // tests. Fixed seed.
  const std::uint32_t replicates = 10000;
  for (const Sampler& s : copied()) {
    const std::string name = with_points(s, "1024");
    const std::uint32_t dim = std::min(s.max_dim, 4U);
    const std::uint64_t size = set_size(name);
    const Plan plan = make_points_plan(test::catalog(), name, dim, Precision::fp64, size + 16,
                                       replicates, 1, test::device().facts());
    PointsDump dump(test::device(), plan);
    // The last point of the first tile, the first and another one of the second.
    const std::array<std::size_t, 3> indices{15, 16, 27};
    std::vector<std::vector<double>> values;  // [index, dimension][replicate]
    values.resize(indices.size() * dim);
    for (std::uint32_t r = 0; r < replicates; ++r) {
      const auto drawn = dump.read(size - 16, 32, size + 16, r, 4);
      for (std::size_t k = 0; k < indices.size(); ++k)
        for (std::size_t d = 0; d < dim; ++d)
          values[k * dim + d].push_back(drawn[indices[k] * dim + d]);
    }
    for (std::size_t a = 0; a < values.size(); ++a)
      for (std::size_t b = 0; b < a; ++b) {
        const bool same_tile = a / dim >= 1 && b / dim >= 1 && a / dim != b / dim;
        if (same_tile) continue;  // points of one set depend on each other
        std::array<double, 64> counts{};
        for (std::size_t r = 0; r < replicates; ++r)
          ++counts[static_cast<std::size_t>(std::floor(values[a][r] * 8) * 8 +
                                            std::floor(values[b][r] * 8))];
        double chi2 = 0;
        const double expected = replicates / 64.0;
        for (const double count : counts)
          chi2 += (count - expected) * (count - expected) / expected;
        INFO(name << " values " << a << ", " << b << ": chi2 = " << chi2);
        CHECK(chi2 < 155);
      }
  }
}

TEST_CASE("copies are drawn alike from any start, across tiles and beyond 2^32", "[device]") {
  for (const Sampler& s : copied()) {
    const std::uint32_t dim = some_dim(s);
    const std::uint64_t size = set_size(s.name);
    // Blocks of 2^16 samples hold several tiles.
    for (const std::uint64_t start : {size - 2048, (std::uint64_t{1} << 33) + size - 2048}) {
      const auto replayed = points({.sampler = s.name,
                                    .dim = dim,
                                    .start = start,
                                    .count = 4096,
                                    .replicate = 1,
                                    .log2_block = 16});
      INFO(s.name << " from " << start);
      REQUIRE(replayed == points({.sampler = s.name,
                                  .dim = dim,
                                  .start = start,
                                  .count = 4096,
                                  .replicate = 1,
                                  .log2_block = 4}));
      const auto part = points(
          {.sampler = s.name, .dim = dim, .start = start + 1234, .count = 2000, .replicate = 1});
      REQUIRE(std::equal(part.begin(), part.end(), replayed.begin() + 1234L * dim));
    }
  }
}

TEST_CASE("fp32 draws the copies of fp64 at 23 bits, and all widths draw the same", "[device]") {
  for (const Sampler& s : copied()) {
    const std::uint32_t dim = some_dim(s);
    const std::uint64_t start = set_size(s.name) - 256;
    const auto draw = [&](Precision precision, std::uint32_t lanes) {
      return points({.sampler = s.name,
                     .dim = dim,
                     .precision = precision,
                     .start = start,
                     .count = 512,
                     .replicate = 2,
                     .lanes_per_item = lanes});
    };
    const auto fine = draw(Precision::fp64, 16), coarse = draw(Precision::fp32, 16);
    for (std::size_t i = 0; i < fine.size(); ++i) {
      INFO(s.name << " value " << i);
      REQUIRE(std::floor(std::ldexp(fine[i], 23)) == std::floor(std::ldexp(coarse[i], 23)));
      REQUIRE((coarse[i] > 0 && coarse[i] < 1 && fine[i] > 0 && fine[i] < 1));
    }
    for (const std::uint32_t lanes : {1U, 4U, 8U}) {
      INFO(s.name << " lanes " << lanes);
      REQUIRE(draw(Precision::fp64, lanes) == fine);
      REQUIRE(draw(Precision::fp32, lanes) == coarse);
    }
  }
}
