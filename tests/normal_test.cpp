// The normal quantile of kernels/transforms/normal.cl: its errors, its ends, its symmetry.
#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

#include "catalog/embedded.hpp"
#include "catalog/json.hpp"
#include "tests/support.hpp"

using namespace koksma;

namespace {

// Values of the piece at x, whose size is a multiple of `lanes`.
template <class T>
std::vector<T> quantiles(const std::vector<T>& x, std::uint32_t lanes) {
  std::string text = "#define KOKSMA_LANES_PER_ITEM " + std::to_string(lanes) +
                     "\n#define KOKSMA_DIM 1\n#define KOKSMA_CENTRED 1\n#define KOKSMA_FP64 " +
                     (std::is_same_v<T, double> ? "1\n" : "0\n");
  text += embedded_text("kernels/prelude.cl");
  text += test::catalog().transform("normal").code.text;
  text +=
      "__kernel void quantiles(__global const scalar *x, __global scalar *out) {\n"
      "  const size_t i = get_global_id(0) * KOKSMA_LANES_PER_ITEM;\n"
      "  store_lanes(normal_quantile(load_lanes(x + i)), out + i);\n}\n";
  Device& device = test::device();
  const std::size_t bytes = x.size() * sizeof(T);
  const cl::Buffer in = device.upload(x.data(), bytes);
  const cl::Buffer out = device.allocate(bytes);
  cl::Kernel kernel(device.build({"quantiles", text, "-cl-std=CL1.2 -w"}).program, "quantiles");
  kernel.setArg(0, in);
  kernel.setArg(1, out);
  device.queue().enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(x.size() / lanes),
                                      cl::NDRange(1));
  std::vector<T> values(x.size());
  device.queue().enqueueReadBuffer(out, CL_TRUE, 0, bytes, values.data());
  return values;
}

template <class T>
std::vector<T> mirrored(std::vector<T> x) {
  for (T& value : x) value = 1 - value;
  return x;
}

// x = j 2^-24, j < 2^23: of the lower half of (0,1) the grid (k + 1/2) 2^-23 at odd j, k 2^-23 at
// even.
const std::vector<float>& fp32_points() {
  static const std::vector<float> x = [] {
    std::vector<float> points(1 << 23);
    for (std::size_t j = 0; j < points.size(); ++j)
      points[j] = std::ldexp(static_cast<float>(j), -24);
    return points;
  }();
  return x;
}

// The points of tests/normal_reference.json, padded by 1/4 to whole vectors, and their quantiles.
struct ReferenceNormal {
  std::vector<double> x;
  std::vector<long double> quantile;
};

ReferenceNormal fp64_reference() {
  const Json file =
      parse_json(test::repository_file("tests/normal_reference.json"), "normal_reference.json");
  ReferenceNormal reference;
  for (const Json& row : file["quantiles"]) {
    reference.x.push_back(std::stod(row[0].get<std::string>()));
    reference.quantile.push_back(std::stold(row[1].get<std::string>()));
  }
  reference.x.resize((reference.x.size() + 15) / 16 * 16, 0.25);
  return reference;
}

template <class T>
double ulps(T value, long double expected) {
  const T size = std::fabs(static_cast<T>(expected));
  const T ulp = std::nextafter(size, std::numeric_limits<T>::infinity()) - size;
  return static_cast<double>(std::fabs(static_cast<long double>(value) - expected) / ulp);
}

}  // namespace

TEST_CASE("in fp32 the normal quantile is within 4 ulp of Boost's at every fifth grid point",
          "[device]") {
  const std::vector<float>& x = fp32_points();
  std::vector<std::size_t> checked;
  for (std::size_t j = 1; j < x.size(); j += 5) checked.push_back(j);
  // Both ends, the seam at t = 0.00097751804, and where the errors of the whole grid were largest.
  for (std::size_t j = 1; j < 4096; ++j) checked.push_back(j);
  for (std::size_t j = 16400 - 512; j < 16400 + 512; ++j) checked.push_back(j);
  for (std::size_t j = 1; j < 4096; ++j) checked.push_back(x.size() - j);
  for (const std::uint32_t k :
       {192069U, 193971U, 194707U, 196299U, 199988U, 200215U, 202275U, 203117U, 209287U, 211913U,
        214079U, 214946U, 216195U, 227697U, 228851U, 231813U, 233777U, 236921U, 255638U, 261653U})
    checked.push_back(2 * std::size_t{k} + 1);
  const std::vector<float> value = quantiles(x, 16);
  const boost::math::normal_distribution<double> normal;
  double worst = 0;
  std::size_t where = 0;
  for (const std::size_t j : checked) {
    const double error = ulps(value[j], quantile(normal, static_cast<double>(x[j])));
    if (!(error <= worst)) worst = error, where = j;
  }
  INFO("largest error at x = " << where << " * 2^-24");
  CHECK(worst <= 4);
}

TEST_CASE("in fp64 the normal quantile is within 4 ulp of the 27-digit values", "[device]") {
  const ReferenceNormal reference = fp64_reference();
  const std::vector<double> value = quantiles(reference.x, 16);
  CHECK(reference.quantile.size() >= 600);
  for (std::size_t i = 0; i < reference.quantile.size(); ++i) {
    INFO("x = " << reference.x[i]);
    CHECK(ulps(value[i], reference.quantile[i]) <= 4);
  }
}

TEST_CASE("the normal quantile is odd about 1/2 bit for bit and, in fp32, never decreases",
          "[device]") {
  const std::vector<float> lower = quantiles(fp32_points(), 16);
  const std::vector<float> upper = quantiles(mirrored(fp32_points()), 16);
  std::size_t even = 0;
  for (std::size_t j = 0; j < lower.size(); ++j) even += lower[j] == -upper[j] ? 0 : 1;
  CHECK(even == 0);
  CHECK(std::is_sorted(lower.begin(), lower.end()));
  CHECK(lower.back() < 0);

  const ReferenceNormal reference = fp64_reference();
  const std::vector<double> below = quantiles(reference.x, 16);
  const std::vector<double> above = quantiles(mirrored(reference.x), 16);
  for (std::size_t i = 0; i < below.size(); ++i) CHECK(below[i] == -above[i]);
}

TEST_CASE("the normal quantile is finite at both ends of the randomized grids, -infinity at 0",
          "[device]") {
  const float end = std::ldexp(1.0F, -24);
  std::vector<float> x(16, 0.25F);
  std::fill_n(x.begin(), 4, 0.0F);
  x[1] = end, x[2] = 1 - end, x[3] = 0.5F;
  std::vector<double> wide(x.begin(), x.end());
  wide[1] = std::ldexp(1.0, -53), wide[2] = 1 - wide[1];
  for (const std::uint32_t lanes : {1U, 4U, 8U, 16U}) {
    const std::vector<float> narrow_values = quantiles(x, lanes);
    const std::vector<double> wide_values = quantiles(wide, lanes);
    INFO(lanes << " lanes");
    CHECK(narrow_values[0] == -std::numeric_limits<float>::infinity());
    CHECK(wide_values[0] == -std::numeric_limits<double>::infinity());
    CHECK(narrow_values[1] == Approx(-5.2947040848545980));
    CHECK(narrow_values[2] == Approx(5.2947040848545980));
    CHECK(wide_values[1] == Approx(-8.2095361516013869));
    CHECK(wide_values[2] == Approx(8.2095361516013869));
    CHECK(narrow_values[3] == 0);
    CHECK(wide_values[3] == 0);
  }
}

TEST_CASE("a normal quantile has the same bits in vectors of 4, 8 and 16, whatever its neighbours",
          "[device]") {
  // In order, vectors lie on one side of the seam; dealt out, points of the tail have 15 neighbours
  // in the centre.
  std::vector<float> ordered(1 << 20), dealt(1 << 20);
  for (std::size_t i = 0; i < ordered.size(); ++i) {
    ordered[i] = fp32_points()[8 * i + 1];
    dealt[(i & 0xFFFF) << 4 | i >> 16] = ordered[i];
  }
  const std::vector<float> values = quantiles(ordered, 16);
  const std::vector<float> other = quantiles(dealt, 16);
  CHECK(quantiles(ordered, 4) == values);
  CHECK(quantiles(ordered, 8) == values);
  std::size_t different = 0;
  for (std::size_t i = 0; i < ordered.size(); ++i)
    different += other[(i & 0xFFFF) << 4 | i >> 16] == values[i] ? 0 : 1;
  CHECK(different == 0);
  const std::vector<double> x = fp64_reference().x;
  const std::vector<double> wide = quantiles(x, 16);
  CHECK(quantiles(x, 4) == wide);
  CHECK(quantiles(x, 8) == wide);
}
