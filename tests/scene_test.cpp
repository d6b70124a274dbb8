// Scenes and sample counts from text: every spelling that is right, and what is said of those that
// are not.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>

#include "error/error.hpp"
#include "tests/support.hpp"

using namespace koksma;
using Catch::Contains;

namespace {

Scene scene(const std::string& text) { return parse_scene(test::catalog(), text, "--scene"); }
std::vector<std::uint64_t> sizes(const std::string& text) { return parse_sizes(text, "--n"); }

}  // namespace

TEST_CASE("a scene is a name with key=value pairs; what is not given has its default", "[unit]") {
  const Integrand& f = test::catalog().integrand("genz-gaussian", "test");
  const Scene plain = scene("genz-gaussian");
  CHECK(plain.integrand == "genz-gaussian");
  CHECK(plain.dim == f.default_dim);
  REQUIRE(plain.parameters.size() == f.parameters.size());
  for (std::size_t i = 0; i < f.parameters.size(); ++i)
    CHECK(plain.parameters[i] == f.parameters[i].default_value);
  const Scene given = scene("genz-gaussian:d=8,h=7.03");
  CHECK(given.dim == 8);
  CHECK(given.parameters[0] == 7.03);
  CHECK(scene("genz-gaussian:h=7.03,d=8").text == given.text);
}

TEST_CASE("a value may be a fraction, rounded once", "[unit]") {
  CHECK(scene("linear-prod:scale=1/3").parameters[0] == 1.0 / 3.0);
  CHECK(scene("linear-prod:scale=2.5e-1").parameters[0] == 0.25);
  for (const char* bad :
       {"linear-prod:scale=1/0", "linear-prod:scale=1/", "linear-prod:scale=/2",
        "linear-prod:scale=1/2/3", "linear-prod:scale=", "linear-prod:scale", "linear-prod:scale=x",
        "linear-prod:scale=nan", "linear-prod:scale=inf", "linear-prod:scale=1x", "linear-prod:=1",
        "linear-prod:,", "linear-prod:d= 3"})
    CHECK_THROWS_AS(scene(bad), InputError);
  CHECK_THROWS_WITH(
      scene("linear-prod:d=3,scale=x"),
      Contains("--scene: 'scale=x' is no key=value with a number") && Contains("a fraction a/b"));
}

TEST_CASE("the canonical text of a scene parses to the same scene and is its own canonical text",
          "[unit]") {
  CHECK(scene("linear-prod").text ==
        "linear-prod:d=" +
            std::to_string(test::catalog().integrand("linear-prod", "test").default_dim));
  for (const Integrand& f : test::catalog().integrands) {
    std::string text = f.name + ":d=" + std::to_string(f.max_dim);
    // A number without a short decimal form, inside the range.
    for (const Parameter& p : f.parameters) {
      const double value = p.min + (p.max - p.min) / 3;
      text += fmt::format(",{}={}", p.name, p.integer ? std::floor(value) : value);
    }
    const Scene once = scene(text);
    const Scene twice = scene(once.text);
    INFO(once.text);
    CHECK(twice.text == once.text);
    CHECK(twice.dim == once.dim);
    CHECK(twice.parameters == once.parameters);
  }
}

TEST_CASE("d out of range names the flag, what was found and what is allowed, for every integrand",
          "[unit]") {
  for (const Integrand& f : test::catalog().integrands) {
    for (const std::string& d :
         {std::to_string(f.max_dim + 1), std::to_string(f.min_dim - 1), std::string("-1"),
          std::string("1e30"), std::to_string(f.min_dim) + ".5"}) {
      INFO(f.name << " d = " << d);
      CHECK_THROWS_AS(scene(f.name + ":d=" + d), InputError);
      CHECK_THROWS_WITH(scene(f.name + ":d=" + d),
                        Contains("--scene: d = ") && Contains("'" + f.name + "'") &&
                            Contains(fmt::format("from {} to {}", f.min_dim, f.max_dim)));
    }
  }
}

TEST_CASE("a parameter out of range names the allowed range, for every parameter", "[unit]") {
  std::size_t parameters = 0;
  for (const Integrand& f : test::catalog().integrands) {
    for (const Parameter& p : f.parameters) {
      ++parameters;
      for (const double bad : {std::nextafter(p.max, 1e300), std::nextafter(p.min, -1e300)}) {
        INFO(f.name << " " << p.name << " = " << bad);
        CHECK_THROWS_WITH(scene(fmt::format("{}:{}={}", f.name, p.name, bad)),
                          Contains("--scene: " + p.name + " = ") &&
                              Contains(fmt::format("allowed: {} to {}", p.min, p.max)) &&
                              Contains(p.meaning));
      }
      for (const double good : {p.min, p.max})
        CHECK_NOTHROW(scene(fmt::format("{}:{}={}", f.name, p.name, good)));
    }
  }
  CHECK(parameters > 10);
}

TEST_CASE("whole-number parameters refuse fractions, and choices all values but theirs", "[unit]") {
  std::size_t whole = 0, choices = 0;
  for (const Integrand& f : test::catalog().integrands) {
    for (const Parameter& p : f.parameters) {
      if (!p.integer) continue;
      ++whole;
      CHECK_THROWS_WITH(scene(fmt::format("{}:{}={}", f.name, p.name, p.min + 0.5)),
                        Contains("a whole number from"));
    }
    for (const Choice& c : f.choices) {
      ++choices;
      for (const std::string& value : c.allowed) {
        const Scene given = scene(fmt::format("{}:{}={}", f.name, c.name, value));
        CHECK(scene(given.text).choices == given.choices);
      }
      CHECK_THROWS_WITH(scene(fmt::format("{}:{}=x", f.name, c.name)),
                        Contains(c.name) && Contains("known: ") && Contains(c.allowed.front()));
    }
  }
  CHECK(whole > 5);
  CHECK(choices > 5);
}

TEST_CASE("an unknown parameter and an unknown scene are told with the nearest spelling",
          "[unit]") {
  CHECK_THROWS_WITH(scene("linear-prod:scael=1"),
                    Contains("unknown parameter of 'linear-prod' 'scael'") &&
                        Contains("did you mean 'scale'?") && Contains("known: d, "));
  CHECK_THROWS_WITH(scene("genz-gausian:d=2"),
                    Contains("--scene: unknown integrand 'genz-gausian'") &&
                        Contains("did you mean 'genz-gaussian'?"));
  CHECK_THROWS_WITH(scene(""), Contains("unknown integrand ''") && Contains("known: "));
}

TEST_CASE(
    "sample counts are powers, ranges, numbers and lists of these, ascending and without "
    "repetition",
    "[unit]") {
  using Sizes = std::vector<std::uint64_t>;
  CHECK(sizes("2^8..2^11") == Sizes{256, 512, 1024, 2048});
  CHECK(sizes("256..1024") == Sizes{256, 512, 1024});
  CHECK(sizes("2^10") == Sizes{1024});
  CHECK(sizes("1000") == Sizes{1000});
  CHECK(sizes("2^4,3,2^3..2^4,1") == Sizes{1, 3, 8, 16});
  CHECK(sizes("2^0..2^62").size() == 63);
  CHECK(sizes("2^0..2^62").back() == 1ULL << 62);
  for (const char* bad : {"",         "0",    "-1",      "+1",         "2^",
                          "2^63",     "2^-1", "1e3",     " 8",         "8 ",
                          "8,",       ",8",   "8..",     "..8",        "2^8..2^9..2^10",
                          "2^9..2^8", "3..5", "2^3..12", "1000..2000", "18446744073709551616",
                          "x"}) {
    INFO("'" << bad << "'");
    CHECK_THROWS_AS(sizes(bad), InputError);
  }
  CHECK_THROWS_WITH(sizes("2^8,12x"), Contains("--n: '12x' in '2^8,12x' is no sample count") &&
                                          Contains("2^8..2^20"));
  CHECK_THROWS_WITH(sizes("2^8..1000"),
                    Contains("--n: '2^8..1000' is no range") && Contains("two powers of two"));
}
