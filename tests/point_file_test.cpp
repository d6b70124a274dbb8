// Points of the user's: .npy and .csv are read exactly, and whatever is wrong with them is told
// with its place.
#include "points/point_file.hpp"

#include <bit>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>

#include "error/error.hpp"
#include "tests/support.hpp"

using namespace koksma;
using koksma::test::points;

namespace {

using Catch::Matchers::Contains;

template <typename Value>
std::string npy(const std::string& fields, const std::vector<Value>& values, int version = 1) {
  std::string header = fields;
  header += std::string(63 - (10 + header.size()) % 64, ' ') + "\n";
  std::string text = "\x93NUMPY";
  text += static_cast<char>(version);
  text += '\0';
  for (int i = 0; i < (version == 1 ? 2 : 4); ++i)
    text += static_cast<char>(header.size() >> (8 * i) & 0xFF);
  text += header;
  const std::size_t begin = text.size();
  text.resize(begin + values.size() * sizeof(Value));
  if (!values.empty())
    std::memcpy(text.data() + begin, values.data(), values.size() * sizeof(Value));
  return text;
}

std::string f8(const std::string& shape) {
  return "{'descr': '<f8', 'fortran_order': False, 'shape': " + shape + ", }";
}

const std::vector<double> kSix{0, 0.25, 0.125, 0.75, 0x1.fffffffffffffp-1, 1.0 / 3};

}  // namespace

TEST_CASE("files of points are read exactly: .npy of both widths and versions, and .csv",
          "[unit]") {
  const test::TemporaryFolder folder;
  const auto values = [&](const std::string& name, const std::string& text) {
    return read_point_file(folder.write(name, text)).values;
  };
  CHECK(values("a.npy", npy(f8("(3, 2)"), kSix)) == kSix);
  CHECK(values("a.npy", npy(f8("(3, 2)"), kSix, 2)) == kSix);
  CHECK(values("a.npy", npy(f8("(6,)"), kSix)) == kSix);
  CHECK(values("a.npy", npy<float>("{'shape': (2, 1), 'descr': '<f4', 'fortran_order': False}",
                                   {0.1F, 0.5F})) == std::vector<double>{0.1F, 0.5});
  CHECK(values("a.csv", "x, y\n0,0.25\n\n1.25e-1 0.75\r\n 0.5 ;.25\t\n") ==
        std::vector<double>{0, 0.25, 0.125, 0.75, 0.5, 0.25});
  CHECK(values("a.csv", "0.5") == std::vector<double>{0.5});
  const PointFile file = read_point_file(folder.write("b.npy", npy(f8("(2, 3)"), kSix)));
  CHECK((file.rows == 2 && file.columns == 3));
}

TEST_CASE("a wrong file of points is refused with the file, the place and what is allowed",
          "[unit]") {
  const test::TemporaryFolder folder;
  const auto refusal = [&](const std::string& name, const std::string& text) {
    const std::string path = folder.write(name, text);
    try {
      read_point_file(path);
    } catch (const InputError& error) {
      CHECK_THAT(error.what(), Contains(path));
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  CHECK_THAT(refusal("a.csv", "0.5,0.5\n0.5,1\n"),
             Contains("a.csv:2, column 2") && Contains(": 1;") && Contains("[0,1)"));
  CHECK_THAT(refusal("a.csv", "0.5\n-1e-9\n"), Contains("a.csv:2, column 1") && Contains("-1e-09"));
  CHECK_THAT(refusal("a.csv", "0.5\nnan\n"), Contains("a.csv:2") && Contains("nan"));
  CHECK_THAT(refusal("a.csv", "0.5,0.5\n0.5\n"), Contains("a.csv:2") && Contains("1 numbers"));
  CHECK_THAT(refusal("a.csv", "0.5,0.5\n0.5,x2\n"), Contains("a.csv:2") && Contains("'x2'"));
  CHECK_THAT(refusal("a.csv", "0.5,y\n0.5,0.5\n"), Contains("a.csv:1") && Contains("'y'"));
  CHECK_THAT(refusal("a.csv", "0.5,0.5,\n"), Contains("a.csv:1") && Contains("''"));
  CHECK_THAT(refusal("a.csv", "x,y\n"), Contains("no points"));
  CHECK_THAT(refusal("a.csv", ""), Contains("no points"));
  CHECK_THAT(refusal("a.txt", "0.5"), Contains(".npy") && Contains(".csv"));
  std::vector<double> bad = kSix;
  bad[3] = 1;
  CHECK_THAT(refusal("a.npy", npy(f8("(3, 2)"), bad)),
             Contains("row 2, column 2") && Contains("[0,1)"));
  bad[3] = std::nan("");
  CHECK_THAT(refusal("a.npy", npy(f8("(3, 2)"), bad)), Contains("row 2, column 2"));
  CHECK_THAT(refusal("a.npy", npy(f8("(3, 3)"), kSix)), Contains("48 bytes") && Contains("3 rows"));
  CHECK_THAT(refusal("a.npy", npy(f8("(2, 2)"), kSix)), Contains("48 bytes"));
  CHECK_THAT(refusal("a.npy", npy(f8("(1, 3, 2)"), kSix)), Contains("one or two axes"));
  CHECK_THAT(refusal("a.npy", npy(f8("()"), kSix)), Contains("one or two axes"));
  CHECK_THAT(refusal("a.npy", npy(f8("(0, 2)"), std::vector<double>{})), Contains("0 rows"));
  CHECK_THAT(refusal("a.npy", npy("{'descr': '>f8', 'fortran_order': False, 'shape': (6,)}", kSix)),
             Contains("'>f8'"));
  CHECK_THAT(
      refusal("a.npy", npy("{'descr': '<f8', 'fortran_order': True, 'shape': (3, 2)}", kSix)),
      Contains("Fortran"));
  CHECK_THAT(refusal("a.npy", npy(f8("(6,)"), kSix, 3)), Contains("version 3"));
  CHECK_THAT(refusal("a.npy", "0.5,0.5\n"), Contains("NumPy"));
  CHECK_THAT(refusal("a.npy", npy(f8("(6,)"), kSix).substr(0, 40)), Contains("header"));
  CHECK_THROWS_WITH(read_point_file(folder.path("none.npy")), Contains("cannot be read"));
}

TEST_CASE("the samples are the rows of the file, rounded down to the grid", "[device]") {
  const test::TemporaryFolder folder;
  std::vector<double> rows;
  for (int i = 0; i < 3 * 37; ++i) rows.push_back(std::fmod(0.1 + i * 0.618033988749895, 1.0));
  const std::string path = folder.write("a.npy", npy(f8("(37, 3)"), rows));
  for (const Precision precision : {Precision::fp32, Precision::fp64}) {
    const int bits = precision == Precision::fp32 ? 23 : 52;
    const auto drawn =
        points({.sampler = "file:path=" + path, .dim = 3, .precision = precision, .count = 37});
    for (std::size_t i = 0; i < rows.size(); ++i)
      REQUIRE(drawn[i] == std::ldexp(std::floor(std::ldexp(rows[i], bits)), -bits));
  }
  const auto narrow = points({.sampler = "file:path=" + path, .dim = 2, .start = 5, .count = 32});
  for (std::size_t i = 0; i < 32; ++i)
    REQUIRE(narrow[2 * i + 1] ==
            std::ldexp(std::floor(std::ldexp(rows[3 * (i + 5) + 1], 52)), -52));

  // Rotation: one shift for all rows.
  const std::string rotated = "file:path=" + path + ",randomize=rotate";
  const auto shifted = points({.sampler = rotated, .dim = 3, .count = 37, .replicate = 4});
  const double u = shifted[0] - rows[0];
  for (std::size_t i = 0; i < 37; ++i)
    CHECK(std::fabs(std::remainder(shifted[3 * i] - rows[3 * i] - u, 1)) < 1e-15);
}

TEST_CASE("a file has its rows and columns: more are refused, with their numbers", "[device]") {
  const test::TemporaryFolder folder;
  const std::string path = folder.write("a.csv", "0.1,0.2\n0.3,0.4\n0.5,0.6\n");
  for (const std::string& sampler :
       {"file:path=" + path, "file:path=" + path + ",randomize=rotate"}) {
    const auto plan = [&](std::uint32_t dim, std::uint64_t n) {
      return make_points_plan(test::catalog(), sampler, dim, Precision::fp64, n, 1, 1,
                              test::device().facts());
    };
    CHECK_NOTHROW(plan(2, 3));
    CHECK_THROWS_AS(plan(2, 4), InputError);
    CHECK_THROWS_WITH(plan(2, 4), Contains(path) && Contains("3 rows") && Contains("4 points"));
    CHECK_THROWS_WITH(plan(3, 3), Contains(path) && Contains("2 columns") && Contains("3 dim"));
  }
}

TEST_CASE("run and points take the user's file, and stop before any work where it is wrong",
          "[device]") {
  const test::TemporaryFolder folder;
  const std::string path = folder.write("a.csv", "0.125,0.25\n0.5,0.75\n");
  const std::string run = "run --quiet --scene linear-prod:d=2 --out " + folder.path("out.json") +
                          " --sampler file:path=" + path;
  const auto good = test::run_command(run + " --n 2 --sum double");
  INFO(good.output);
  CHECK(good.status == 0);
  const Json cell = parse_json(read_text_file(folder.path("out.json")), "out.json")["cells"][0];
  CHECK(cell["sampler"] == "file:path=" + path);
  const auto too_many = test::run_command(run + " --n 2^4");
  CHECK(too_many.status == 2);
  CHECK_THAT(too_many.output, Contains(path) && Contains("2 rows"));
  CHECK(test::run_command("run --quiet --scene linear-prod:d=2 --sampler file").status == 2);
  const auto dumped = test::run_command("points --sampler file:path=" + path +
                                        " --dim 2 --n 2 --out " + folder.path("p.csv"));
  CHECK(dumped.status == 0);
  CHECK(read_text_file(folder.path("p.csv")) == "0.125,0.25\n0.5,0.75\n");
}

TEST_CASE("plus signs and a byte order mark do not turn the first point into a heading", "[unit]") {
  const koksma::test::TemporaryFolder folder;
  for (const char* text : {"+0.125,+0.25\n0.5,0.75\n",
                           "\xEF\xBB\xBF"
                           "0.125,0.25\n0.5,0.75\n"}) {
    const PointFile file = read_point_file(folder.write("points.csv", text));
    CHECK(file.rows == 2);
    CHECK(file.values == std::vector<double>{0.125, 0.25, 0.5, 0.75});
  }
}
