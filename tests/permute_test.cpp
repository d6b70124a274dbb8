// The keyed bijections of kernels/points/parts/permute.cl: that they are bijections, and that all
// of them are equally likely.
#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>

#include "catalog/embedded.hpp"
#include "points/grids.hpp"
#include "tests/support.hpp"

using namespace koksma;

namespace {

constexpr std::size_t kLanes = 16;

// Images of 16 numbers under each of many keys, through a kernel of this test.
class Bijections {
 public:
  Bijections(std::uint32_t lanes, bool fp64) {
    const std::string body = R"(
__kernel void images(ulong n, __global const uint *numbers, __global const uint *keys, __global uint *out) {
  const size_t k = get_global_id(0);
  const bijection s = bijection_on(n);
  for (uint i = 0; i < KOKSMA_LANES; i += KOKSMA_LANES_PER_ITEM)
    store_lanes(permute(load_lanes(numbers + i), s, (words32)keys[2 * k], (words32)keys[2 * k + 1]), out + k * KOKSMA_LANES + i);
})";
    std::string text = "#define KOKSMA_LANES_PER_ITEM " + std::to_string(lanes) +
                       "\n#define KOKSMA_DIM 1\n#define KOKSMA_CENTRED 1\n#define KOKSMA_FP64 " +
                       std::to_string(fp64) + "\n";
    for (const char* path : {"kernels/prelude.cl", "kernels/points/parts/philox.cl",
                             "kernels/points/parts/permute.cl"})
      text += embedded_text(path);
    kernel_ = cl::Kernel(
        test::device().build({"bijections", text + body, "-cl-std=CL1.2 -w"}).program, "images");
  }

  // [key][16]; the keys are those of replicates first_replicate, ...
  std::vector<std::uint32_t> operator()(std::uint64_t n, const std::vector<std::uint32_t>& numbers,
                                        std::uint32_t keys, std::uint32_t first_replicate = 0) {
    std::vector<std::uint64_t> wide;
    PointRequest request;
    request.seed = 1;
    for (std::uint32_t r = 0; r < keys; ++r)
      append_bijection(wide, request, first_replicate + r, 0);
    const std::vector<std::uint32_t> narrow(wide.begin(), wide.end());
    std::vector<std::uint32_t> padded = numbers;
    padded.resize(kLanes, numbers.front());
    Device& device = test::device();
    const cl::Buffer in = device.upload(padded.data(), padded.size() * 4);
    const cl::Buffer key_buffer = device.upload(narrow.data(), narrow.size() * 4);
    std::vector<std::uint32_t> images(keys * kLanes);
    const cl::Buffer out = device.allocate(images.size() * 4);
    kernel_.setArg(0, cl_ulong{n});
    kernel_.setArg(1, in);
    kernel_.setArg(2, key_buffer);
    kernel_.setArg(3, out);
    device.queue().enqueueNDRangeKernel(kernel_, cl::NullRange, cl::NDRange(keys), cl::NDRange(1));
    device.queue().enqueueReadBuffer(out, CL_TRUE, 0, images.size() * 4, images.data());
    return images;
  }

 private:
  cl::Kernel kernel_;
};

Bijections& wide_bijections() {
  static Bijections made(16, false);
  return made;
}

// Images of 0 ... n-1 under one key.
std::vector<std::uint32_t> whole(Bijections& bijections, std::uint32_t n, std::uint32_t key) {
  std::vector<std::uint32_t> result;
  for (std::uint32_t first = 0; first < n; first += kLanes) {
    std::vector<std::uint32_t> numbers(kLanes);
    for (std::uint32_t l = 0; l < kLanes; ++l) numbers[l] = first + l;
    const auto images = bijections(n, numbers, 1, key);
    result.insert(result.end(), images.begin(),
                  images.begin() + std::min<std::ptrdiff_t>(kLanes, n - first));
  }
  return result;
}

// Probability of counts at least as uneven as these, if `cells` cells were equally likely.
double evenness(const std::vector<std::uint32_t>& counts, std::size_t cells) {
  double total = 0, statistic = 0;
  for (const std::uint32_t c : counts) total += c;
  const double expected = total / static_cast<double>(cells);
  for (const std::uint32_t c : counts) statistic += (c - expected) * (c - expected) / expected;
  statistic += static_cast<double>(cells - counts.size()) * expected;
  return cdf(complement(boost::math::chi_squared(std::max(1.0, static_cast<double>(cells) - 1)),
                        statistic));
}

// Ordered pairs of different numbers below n, as one number below n (n - 1).
std::size_t pair_number(std::size_t n, std::size_t x, std::size_t y) {
  return x * (n - 1) + (y > x ? y - 1 : y);
}

// Kensler's hash of 2013 (Pixar memo 13-01, section 5) as printed there.
std::uint32_t kensler(std::uint32_t i, std::uint32_t l, std::uint32_t p) {
  std::uint32_t w = l - 1;
  for (int s = 1; s < 32; s *= 2) w |= w >> s;
  do {
    i ^= p;
    i *= 0xe170893d;
    i ^= p >> 16;
    i ^= (i & w) >> 4;
    i ^= p >> 8;
    i *= 0x0929eb3f;
    i ^= p >> 23;
    i ^= (i & w) >> 1;
    i *= 1 | p >> 27;
    i *= 0x6935fa69;
    i ^= (i & w) >> 11;
    i *= 0x74dcb303;
    i ^= (i & w) >> 2;
    i *= 0x9e501cc3;
    i ^= (i & w) >> 2;
    i *= 0xc860a3df;
    i &= w;
    i ^= i >> 5;
  } while (i >= l);
  return (i + p) % l;
}

}  // namespace

TEST_CASE("a keyed bijection takes every value once, for every n up to 200 and larger ones",
          "[device]") {
  std::vector<std::uint32_t> sizes{256, 257, 1000, 1023, 4096, 4097, 32768, 65537};
  for (std::uint32_t n = 1; n <= 200; ++n) sizes.push_back(n);
  for (const std::uint32_t n : sizes) {
    auto images = whole(wide_bijections(), n, n);
    std::sort(images.begin(), images.end());
    INFO("n = " << n);
    for (std::uint32_t i = 0; i < n; ++i) REQUIRE(images[i] == i);
  }
}

TEST_CASE("the images are the same at 1 lane in fp64 and at 16 in fp32, up to n = 2^32",
          "[device]") {
  Bijections narrow(1, true);
  for (const std::uint64_t n :
       {1ULL, 2ULL, 37ULL, 1000ULL, 1ULL << 20, (1ULL << 30) + 1, (1ULL << 32) - 5, 1ULL << 32}) {
    std::vector<std::uint32_t> numbers(kLanes);
    for (std::size_t l = 0; l < kLanes; ++l)
      numbers[l] = static_cast<std::uint32_t>((n - 1) / kLanes * l + (n - 1) % kLanes * l / kLanes);
    numbers.back() = static_cast<std::uint32_t>(n - 1);
    const auto images = wide_bijections()(n, numbers, 100);
    REQUIRE(images == narrow(n, numbers, 100));
    for (std::size_t k = 0; k < images.size(); ++k) {
      INFO("n = " << n);
      REQUIRE(images[k] < n);
      // Different numbers below n have different images.
      for (std::size_t l = k / kLanes * kLanes; l < k; ++l)
        REQUIRE((images[l] == images[k]) == (numbers[l % kLanes] == numbers[k % kLanes]));
    }
  }
}

TEST_CASE("all n! permutations are equally frequent for n = 2 to 6", "[statistical]") {
  // 10^5 keys, chi-squared: false alarm 1e-7 each. With ideal round functions the total variation
  // distance is 3e-10 (n = 4) to 1e-5 (n = 5, 6), by exact computation.
  std::vector<std::uint32_t> numbers(kLanes);
  std::size_t factorial = 1;
  for (std::uint32_t n = 2; n <= 6; ++n) {
    factorial *= n;
    for (std::uint32_t l = 0; l < kLanes; ++l) numbers[l] = std::min(l, n - 1);
    const auto images = wide_bijections()(n, numbers, 100000);
    std::map<std::vector<std::uint32_t>, std::uint32_t> seen;
    for (auto key = images.begin(); key != images.end(); key += kLanes)
      ++seen[std::vector<std::uint32_t>(key, key + n)];
    std::vector<std::uint32_t> counts;
    for (const auto& [permutation, count] : seen) counts.push_back(count);
    INFO("n = " << n);
    CHECK(seen.size() == factorial);
    CHECK(evenness(counts, factorial) > 1e-7);
  }
}

TEST_CASE("the image of one number is uniform, and that of two numbers on all pairs",
          "[statistical]") {
  // Neighbours, numbers of one left or right half, the ends. 2^18 keys; 6 sizes x 22 tests of 1e-8.
  const std::uint32_t keys = 1 << 18;
  for (const std::uint32_t n : {8U, 12U, 16U, 37U, 100U, 256U}) {
    const std::uint32_t a = 1U << static_cast<std::uint32_t>(std::log2(n - 1) + 1) / 2;
    std::vector<std::uint32_t> numbers{0, 1, 2, 3, a, a + 1, n / 2, n - 2, n - 1};
    const std::size_t used = numbers.size();
    const auto images = wide_bijections()(n, numbers, keys);
    for (std::size_t l = 0; l < used; ++l) {
      std::vector<std::uint32_t> counts(n, 0);
      for (std::uint32_t k = 0; k < keys; ++k) ++counts[images[k * kLanes + l]];
      INFO("n = " << n << ", image of " << numbers[l]);
      CHECK(evenness(counts, n) > 1e-8);
    }
    for (const auto& [x, y] : std::initializer_list<std::pair<std::size_t, std::size_t>>{
             {0, 1}, {0, 2}, {1, 2}, {2, 3}, {0, 4}, {1, 5}, {0, 5}, {0, 8}, {7, 8}, {6, 8}}) {
      if (numbers[x] == numbers[y]) continue;
      std::vector<std::uint32_t> counts(std::size_t{n} * (n - 1), 0);
      for (std::uint32_t k = 0; k < keys; ++k)
        ++counts[pair_number(n, images[k * kLanes + x], images[k * kLanes + y])];
      INFO("n = " << n << ", images of " << numbers[x] << " and " << numbers[y]);
      CHECK(evenness(counts, counts.size()) > 1e-8);
    }
  }
}

TEST_CASE("large bijections spread two numbers over all pairs of 64 parts", "[statistical]") {
  const std::uint32_t keys = 1 << 17;
  for (const std::uint64_t n : {65536ULL, 65537ULL, 1000000ULL, 1ULL << 30, 1ULL << 32}) {
    const std::uint32_t a =
        1U << static_cast<std::uint32_t>(std::log2(static_cast<double>(n - 1)) + 1) / 2;
    const auto last = static_cast<std::uint32_t>(n - 1);
    const auto images = wide_bijections()(n, {0, 1, a, a + 1, last}, keys);
    for (const auto& [x, y] : std::initializer_list<std::pair<std::size_t, std::size_t>>{
             {0, 1}, {0, 2}, {0, 3}, {2, 3}, {0, 4}}) {
      std::vector<std::uint32_t> counts(4096, 0);
      for (std::uint32_t k = 0; k < keys; ++k)
        ++counts[images[k * kLanes + x] * 64ULL / n * 64 + images[k * kLanes + y] * 64ULL / n];
      INFO("n = " << n << ", pair " << x << " " << y);
      // n is large: that the images differ changes a count of 32 by less than 0.04.
      CHECK(evenness(counts, 4096) > 1e-8);
    }
  }
}

TEST_CASE("the test of uniformity refuses Kensler's hash of 2013", "[unit]") {
  std::vector<std::uint32_t> counts(16UL * 15, 0);
  for (std::uint32_t k = 0; k < 1 << 16; ++k) {
    const auto p = static_cast<std::uint32_t>(
        random_pair(1, 0, k, RandomPurpose::index_permutation, 0).first >> 32);
    ++counts[pair_number(16, kensler(0, 16, p), kensler(1, 16, p))];
  }
  CHECK(evenness(counts, counts.size()) < 1e-8);
}
