// Recursive Wang tiles: the rule cuts tiles that fit into tiles that fit, the points of a level are
// among those of the next, and samples are where the digits of their index lead.
#include <Random123/philox.h>

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <complex>
#include <set>

#include "points/tables.hpp"
#include "tests/numbers.hpp"
#include "tests/support.hpp"

using namespace koksma;
using koksma::test::circle_distance;
using koksma::test::points;
using koksma::test::PointsSpec;

namespace {

constexpr const char* kName = "wang-tiles";
constexpr std::size_t kTypes = 16, kWangCells = 16, kOwn = 16, kRanks = 256;

struct Word {
  std::uint64_t x, y;
  auto operator<=>(const Word&) const = default;
};

// The table as kernels/points/wang.cl says: places in units of 2^-32 tiles.
struct Tiles {
  double declared;
  std::vector<std::uint64_t> words;

  explicit Tiles(std::uint64_t seed) {
    const Sampler s = test::catalog().sampler(kName, "test");
    declared = s.options["minimum_distance"];
    PointRequest request;
    request.options = s.options;
    request.dim = 2;
    request.seed = seed;
    words = find_table_builder(s.family)(request).words;
    REQUIRE(words.size() == 2 * kWangCells + 2 * kTypes * kRanks);
  }
  std::size_t cell_type(std::size_t type, std::size_t cell) const {
    return words[type / 8 * kWangCells + cell] >> 4 * (type % 8) & 15;
  }
  Word at(std::size_t type, std::size_t rank) const {
    const std::size_t first = 2 * kWangCells + rank * kTypes + type;
    return {words[first], words[first + kTypes * kRanks]};
  }
  // Of the tiles' own points, in tiles.
  double nearest(std::size_t a, std::size_t b, double dx, double dy) const {
    double least = INFINITY;
    const bool itself = a == b && dx == 0 && dy == 0;
    const auto tiles = [](std::uint64_t word) {
      return std::ldexp(static_cast<double>(word), -32);
    };
    for (std::size_t i = 0; i < kOwn; ++i)
      for (std::size_t j = 0; j < kOwn; ++j) {
        const Word p = at(a, i), q = at(b, j);
        const double x = tiles(q.x) + dx - tiles(p.x), y = tiles(q.y) + dy - tiles(p.y);
        if (!itself || i != j) least = std::min(least, std::hypot(x, y));
      }
    return least;
  }
};

std::size_t colour(std::size_t type, std::size_t edge) { return type >> edge & 1; }

// Outputs 0, 1 (shifts) and 2 (colours) of quartet 0 of purpose 11, index 0 (kernels/README.md).
std::array<std::uint64_t, 3> key(std::uint64_t seed, std::uint32_t replicate) {
  std::array<std::uint64_t, 3> words{};
  for (const std::uint32_t block : {0U, 1U}) {
    const auto drawn = r123::Philox4x32{}(
        {{0, 0, replicate, 11U << 24 | block}},
        {{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)}});
    for (std::size_t i = 0; i < 3; ++i) words[i] = words[i] << 32 | drawn[i];
  }
  return words;
}

// The cells of a square of 4 x 4 in order: quarters, diagonal ones first, then theirs.
std::size_t ordered_cell(std::uint64_t digit) {
  constexpr std::array<std::size_t, 4> kDiagonal{0, 3, 2, 1};
  const std::size_t outer = kDiagonal[digit & 3], inner = kDiagonal[digit >> 2];
  return 2 * (outer & 1) + (inner & 1) + 4 * (2 * (outer >> 1) + (inner >> 1));
}

// Sample `index` from the words of the entry: exact to all bits of both coordinates.
std::array<double, 2> expected(const Tiles& tiles, std::uint64_t index, std::uint64_t seed,
                               std::uint32_t replicate) {
  const auto [shift_x, shift_y, colours] = key(seed, replicate);
  // Digits of base 16 lead to the tile until the others are a rank.
  std::vector<std::uint64_t> digits;
  std::uint64_t rank = index;
  do {
    digits.push_back(rank % 16);
    rank /= 16;
  } while (rank >= kRanks);
  std::size_t type = 0;
  unsigned bits = 64;
  Word place{0, 0};
  for (std::size_t level = 0; level < digits.size(); ++level) {
    const std::size_t cell = ordered_cell(digits[level]);
    const auto edge = [&, word = colours](std::size_t at) { return word >> (32 + at) & 1; };
    const std::size_t x = cell % 4, y = cell / 4;
    type = level > 0 ? tiles.cell_type(type, cell)
                     : edge(cell) | edge(y * 4 + (x + 1) % 4) << 1 | edge(16 + cell) << 2 |
                           edge(16 + (y + 1) % 4 * 4 + x) << 3;
    bits -= 2;
    place = {place.x | x << bits, place.y | y << bits};
  }
  const Word within = tiles.at(type, rank);
  place = {place.x | within.x << (bits - 32), place.y | within.y << (bits - 32)};
  const auto shifted = [](std::uint64_t word, std::uint64_t shift) {
    const std::uint64_t high = (word >> 32) + (shift >> 32);
    const std::uint64_t both = high << 32 | ((word ^ shift) & 0xFFFFFFFF);
    return std::ldexp(static_cast<double>(both >> 12) + 0.5, -52);
  };
  return {shifted(place.x, shift_x), shifted(place.y, shift_y)};
}

// To the nearest neighbour of every point that is nearer than about 1 / sqrt(N).
std::vector<double> nearest_distances(const std::vector<double>& xy) {
  const std::size_t n = xy.size() / 2;
  const auto side = static_cast<std::size_t>(std::sqrt(static_cast<double>(n)));
  const auto cell = [&](double x) {
    return static_cast<std::size_t>(x * static_cast<double>(side));
  };
  std::vector<std::vector<std::size_t>> cells(side * side);
  for (std::size_t i = 0; i < n; ++i)
    cells[cell(xy[2 * i + 1]) * side + cell(xy[2 * i])].push_back(i);
  std::vector<double> nearest(n, INFINITY);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t around = 0; around < 9; ++around) {
      const std::size_t y = (cell(xy[2 * i + 1]) + side - 1 + around / 3) % side;
      const std::size_t x = (cell(xy[2 * i]) + side - 1 + around % 3) % side;
      for (const std::size_t j : cells[y * side + x])
        if (i != j)
          nearest[i] =
              std::min(nearest[i], std::hypot(circle_distance(xy[2 * i], xy[2 * j]),
                                              circle_distance(xy[2 * i + 1], xy[2 * j + 1])));
    }
  return nearest;
}

}  // namespace

TEST_CASE("the rule cuts edges of one colour alike and tiles into cells that fit", "[unit]") {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const Tiles tiles(seed);
    // [direction][colour][place along the edge], at lower or left edges of any type.
    std::array<std::array<std::array<std::size_t, 4>, 2>, 2> along{};
    for (std::size_t k = 0; k < 4; ++k)
      for (const std::size_t c : {0U, 1U}) {
        along[0][c][k] = colour(tiles.cell_type(c, 4 * k), 0);
        along[1][c][k] = colour(tiles.cell_type(c << 2, k), 2);
      }
    REQUIRE((along[0][0] != along[0][1] && along[1][0] != along[1][1]));
    for (std::size_t type = 0; type < kTypes; ++type)
      for (std::size_t k = 0; k < 4; ++k) {
        INFO("seed " << seed << ", type " << type << ", " << k);
        const auto across = [&](std::size_t column) {
          return tiles.cell_type(type, column + 4 * k);
        };
        const auto up = [&](std::size_t row) { return tiles.cell_type(type, k + 4 * row); };
        REQUIRE(colour(across(0), 0) == along[0][colour(type, 0)][k]);
        REQUIRE(colour(across(3), 1) == along[0][colour(type, 1)][k]);
        REQUIRE(colour(up(0), 2) == along[1][colour(type, 2)][k]);
        REQUIRE(colour(up(3), 3) == along[1][colour(type, 3)][k]);
        for (std::size_t i = 0; i < 3; ++i) {
          REQUIRE(colour(across(i), 1) == colour(across(i + 1), 0));
          REQUIRE(colour(up(i), 3) == colour(up(i + 1), 2));
        }
      }
  }
}

TEST_CASE("own points of tiles beside each other keep the distance wherever their edges agree",
          "[unit]") {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const Tiles tiles(seed);
    const double least = tiles.declared / std::sqrt(static_cast<double>(kOwn));
    for (std::size_t a = 0; a < kTypes; ++a) {
      REQUIRE(tiles.nearest(a, a, 0, 0) >= least);
      for (std::size_t b = 0; b < kTypes; ++b) {
        INFO("types " << a << ", " << b);
        if (colour(a, 1) == colour(b, 0)) REQUIRE(tiles.nearest(a, b, 1, 0) >= least);
        if (colour(a, 3) == colour(b, 2)) REQUIRE(tiles.nearest(a, b, 0, 1) >= least);
        REQUIRE(tiles.nearest(a, b, 1, 1) >= least);
        REQUIRE(tiles.nearest(a, b, -1, 1) >= least);
      }
    }
  }
}

TEST_CASE(
    "a tile's points are its cells' own points, its own among them, one more per cell a round",
    "[unit]") {
  for (const std::uint64_t seed : {1U, 2U}) {
    const Tiles tiles(seed);
    for (std::size_t type = 0; type < kTypes; ++type) {
      std::set<Word> of_tile, of_cells;
      for (std::size_t cell = 0; cell < kWangCells; ++cell)
        for (std::size_t rank = 0; rank < kOwn; ++rank) {
          const Word w = tiles.at(tiles.cell_type(type, cell), rank);
          of_cells.insert({(cell & 3) << 30 | w.x >> 2, cell >> 2 << 30 | w.y >> 2});
        }
      for (std::size_t round = 0; round < kRanks; round += kWangCells) {
        std::set<std::size_t> cells;
        for (std::size_t rank = round; rank < round + kWangCells; ++rank) {
          const Word w = tiles.at(type, rank);
          of_tile.insert(w);
          cells.insert(w.x >> 30 | w.y >> 30 << 2);
        }
        REQUIRE(cells.size() == kWangCells);
      }
      INFO("seed " << seed << ", type " << type);
      REQUIRE(of_tile.size() == kRanks);
      REQUIRE(of_tile == of_cells);
    }
  }
}

TEST_CASE("full levels keep the declared distance, other sizes a good part of it", "[device]") {
  const double declared = Tiles(1).declared;
  for (const std::uint64_t n : {64U, 100U, 256U, 300U, 600U, 1024U, 2000U, 4096U, 5000U, 65536U})
    for (const std::uint32_t r : {0U, 1U, 2U}) {
      const auto nearest =
          nearest_distances(points({.sampler = kName, .dim = 2, .count = n, .replicate = r}));
      const double scaled =
          *std::min_element(nearest.begin(), nearest.end()) * std::sqrt(static_cast<double>(n));
      INFO("N = " << n << ": " << scaled);
      CHECK(scaled >= (n == 256 || n == 4096 || n == 65536 ? declared * (1 - 1e-6) : 0.4));
    }
}

TEST_CASE("full levels have one point in every cell, and every part of one its share", "[device]") {
  // Before the shift. Distinct cells are distinct points: no sample of a prefix is drawn twice.
  const auto counts = [](std::uint64_t n, std::uint64_t side, std::uint32_t replicate) {
    const auto xy = points({.sampler = kName, .dim = 2, .count = n, .replicate = replicate});
    const auto [shift_x, shift_y, colours] = key(1, replicate);
    std::vector<std::uint64_t> result(side * side);
    const auto cell = [&](double x, std::uint64_t shift) {
      const auto place = static_cast<std::uint32_t>(std::ldexp(x, 32));
      return (place - static_cast<std::uint32_t>(shift >> 32)) * side >> 32;
    };
    for (std::size_t i = 0; i < n; ++i)
      ++result[cell(xy[2 * i + 1], shift_y) * side + cell(xy[2 * i], shift_x)];
    return result;
  };
  for (const std::uint32_t r : {0U, 7U}) {
    for (const std::uint64_t side : {16U, 64U, 256U})
      CHECK(counts(side * side, side, r) == std::vector<std::uint64_t>(side * side, 1));
    for (const std::uint64_t m : {2U, 5U, 8U, 15U}) {
      INFO("replicate " << r << ", " << m << " points a cell");
      CHECK(counts(256 * m, 16, r) == std::vector<std::uint64_t>(256, m));
      CHECK(counts(4096 * m, 64, r) == std::vector<std::uint64_t>(4096, m));
    }
  }
}

TEST_CASE("a sample is where its index's digits lead, to the last bit, up to index 2^52",
          "[device]") {
  for (const std::uint64_t seed : {1U, 2U}) {
    const Tiles tiles(seed);
    for (const std::uint64_t start :
         {0ULL, 3900ULL, 65500ULL, 1ULL << 24, 0xFFFFFF80ULL, 0xABCDE0123ULL, (1ULL << 44) - 100,
          0x71234ABCD9F02ULL, (1ULL << 52) - 300})
      for (const std::uint32_t r : {0U, 5U}) {
        PointsSpec spec{.sampler = kName, .dim = 2, .start = start, .count = 300};
        spec.replicate = r;
        spec.seed = seed;
        const auto xy = points(spec);
        std::set<std::array<double, 2>> seen;
        for (std::size_t i = 0; i < spec.count; ++i) {
          INFO("seed " << seed << ", replicate " << r << ", index " << start + i);
          const std::array<double, 2> sample{xy[2 * i], xy[2 * i + 1]};
          REQUIRE(sample == expected(tiles, start + i, seed, r));
          REQUIRE(seen.insert(sample).second);
        }
      }
  }
}

TEST_CASE("the mean of all tiles is even, so that tilings do not repeat at the tiles' frequency",
          "[unit]") {
  // Power of the 256 own points at the lowest frequencies per tile over its most, 256^2.
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U}) {
    const Tiles tiles(seed);
    double power = 0;
    for (const auto& [f, g] : {std::pair{1, 0}, {0, 1}, {1, 1}, {1, -1}}) {
      std::complex<double> sum = 0;
      for (std::size_t i = 0; i < kTypes * kOwn; ++i) {
        const Word w = tiles.at(i / kOwn, i % kOwn);
        const double turns = f * static_cast<double>(w.x) + g * static_cast<double>(w.y);
        sum += std::polar(1.0, 2 * M_PI * std::ldexp(turns, -32));
      }
      power += std::norm(sum) / (kTypes * kOwn * kTypes * kOwn);
    }
    INFO("seed " << seed << ": " << power);
    CHECK(power < 0.0065);  // 0.008 to 0.012 where the search does not look at the spectrum
  }
}

TEST_CASE("replicates and seeds have tilings of their own, not only shifts", "[device]") {
  // Distances to the nearest neighbour, sorted, do not see shifts and the order of the points.
  const auto fingerprint = [&](std::uint32_t r, std::uint64_t seed) {
    auto nearest = nearest_distances(
        points({.sampler = kName, .dim = 2, .count = 1024, .replicate = r, .seed = seed}));
    std::sort(nearest.begin(), nearest.end());
    return nearest;
  };
  const auto first = fingerprint(0, 1);
  for (const auto& other : {fingerprint(1, 1), fingerprint(2, 1), fingerprint(0, 2)}) {
    std::size_t differ = 0;
    for (std::size_t i = 0; i < 1024; ++i) differ += std::fabs(first[i] - other[i]) > 1e-8 ? 1 : 0;
    CHECK(differ > 512);
  }
}

TEST_CASE("samples of tiles are uniform at a fixed index over 10^4 replicates", "[statistical]") {
  // chi-squared, 63 degrees of freedom: above 155 with probability 6e-10. Fixed seed.
  const std::uint64_t n = std::uint64_t{1} << 40;
  const std::uint32_t replicates = 10000;
  const Plan plan = make_points_plan(test::catalog(), kName, 2, Precision::fp64, n, replicates, 1,
                                     test::device().facts());
  PointsDump dump(test::device(), plan);
  for (const std::uint64_t index : {std::uint64_t{0}, std::uint64_t{1499}, n - 1}) {
    // Of the coordinates' three leading bits, and of bits 36 ... 38, beyond the shift's high half.
    std::array<double, 64> leading{}, fine{};
    for (std::uint32_t r = 0; r < replicates; ++r) {
      const auto xy = dump.read(index, 1, n, r, 4);
      const auto digit = [](double x, int bits) {
        return static_cast<std::size_t>(std::ldexp(x, bits)) % 8;
      };
      ++leading[digit(xy[0], 3) * 8 + digit(xy[1], 3)];
      ++fine[digit(xy[0], 38) * 8 + digit(xy[1], 38)];
    }
    const auto chi2 = [](const std::array<double, 64>& counts) {
      double sum = 0;
      for (const double count : counts) sum += (count - 156.25) * (count - 156.25) / 156.25;
      return sum;
    };
    INFO("index " << index << ": chi2 = " << chi2(leading) << " and " << chi2(fine));
    CHECK(chi2(leading) < 155);
    CHECK(chi2(fine) < 155);
  }
}

TEST_CASE("both precisions draw the same samples of tiles, whatever the shift", "[device]") {
  // Whether anything is carried from the low half of a coordinate into the high one shows rarely.
  const std::uint64_t n = 4096;
  const std::uint32_t replicates = 2000;
  const auto plan = [&](Precision precision) {
    return make_points_plan(test::catalog(), kName, 2, precision, n, replicates, 1,
                            test::device().facts());
  };
  const Plan fine_plan = plan(Precision::fp64), coarse_plan = plan(Precision::fp32);
  PointsDump fine(test::device(), fine_plan), coarse(test::device(), coarse_plan);
  for (std::uint32_t r = 0; r < replicates; ++r) {
    const auto x = fine.read(n - 16, 16, n, r, 4), y = coarse.read(n - 16, 16, n, r, 4);
    INFO("replicate " << r);
    for (std::size_t i = 0; i < x.size(); ++i)
      REQUIRE(std::floor(std::ldexp(x[i], 23)) == std::floor(std::ldexp(y[i], 23)));
  }
}

TEST_CASE("samples of tiles are the same from any start and at all widths, in both precisions",
          "[device]") {
  for (const std::uint64_t start : {0ULL, 0xFFFFF800ULL, (1ULL << 45) + 77})
    for (const std::uint64_t n : {7U, 5000U}) {
      const PointsSpec all{
          .sampler = kName, .dim = 2, .start = start, .count = n, .replicate = 3, .log2_block = 4};
      const auto fine = points(all);
      INFO("from " << start << ", " << n);
      PointsSpec replayed = all, part = all;
      replayed.log2_block = 16;
      REQUIRE(fine == points(replayed));
      part.start = start + n / 3;
      part.count = n / 2;
      const auto middle = points(part);
      REQUIRE(
          std::equal(middle.begin(), middle.end(), fine.begin() + static_cast<long>(2 * (n / 3))));
      PointsSpec narrow = all;
      narrow.precision = Precision::fp32;
      const auto coarse = points(narrow);
      for (const std::uint32_t lanes : {1U, 4U, 8U}) {
        PointsSpec wide = all;
        wide.lanes_per_item = lanes;
        REQUIRE(points(wide) == fine);
        wide.precision = Precision::fp32;
        REQUIRE(points(wide) == coarse);
      }
    }
}
