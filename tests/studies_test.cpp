// Ready studies as CI runs them: the gated table of rates, the whole catalog at small N, and the
// published dimension test.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <map>

#include "study/templates.hpp"
#include "tests/support.hpp"

using namespace koksma;

namespace {

// The results of a ready study with these flags.
Json run_study(const std::string& name, const std::string& flags) {
  const test::TemporaryFolder folder;
  const std::string study = folder.write(name + ".json", ready_study(test::catalog(), name).dump());
  const std::string out = folder.path("results.json");
  const auto run = test::run_command(fmt::format("run {} --quiet {} --out {}", study, flags, out));
  INFO(run.output);
  REQUIRE(run.status == 0);
  return parse_json(read_text_file(out), out);
}

std::string label(const Json& cell) {
  return cell["scene"]["text"].get<std::string>() + " with " + cell["sampler"].get<std::string>();
}

}  // namespace

TEST_CASE("the gated table of rates holds: d <= 2, N = 2^8 to 2^16, 32 replicates, fp64",
          "[statistical]") {
  // A gate is 5 standard deviations of a slope wide (5-numerics 1.9), 6e-7 per gated cell; the
  // chi-squared tests of `random` have 1e-6 per cell. Fixed seed.
  std::map<std::string, std::size_t> within;
  const Json results = run_study("rates", "");
  for (const Json& cell : results["cells"]) {
    const Json& convergence = cell["convergence"];
    INFO(label(cell) << ": rate " << convergence["rate"] << ", target " << convergence["target"]
                     << ", " << convergence["verdict_reason"]);
    CHECK(cell["status"] == "ok");
    CHECK(convergence["verdict"] != "outside-gate");
    if (convergence["verdict"] == "within-gate") ++within[cell["sampler"]];
  }
  // As many as the table has of each; a gate that stops to apply shows here.
  CHECK(within["random"] >= 20);
  CHECK(within["sobol-owen"] >= 15);
  CHECK(within["lattice-shift"] >= 8);
  CHECK(within["lattice-shift-tent"] >= 2);
  CHECK(within["sobol-interlaced-2"] >= 3);
  CHECK(within["sobol-interlaced-3"] >= 3);
}

TEST_CASE("the whole catalog runs at small N, every verdict one that its integrand may have",
          "[statistical]") {
  // The level of BIASED is 1e-6 over all rows of the run. Both samplers are randomized: no sample
  // meets a singularity.
  std::size_t judged = 0;
  const Json results = run_study("full", "--n 2^8..2^10 --sampler random --sampler sobol-owen");
  for (const Json& cell : results["cells"]) {
    INFO(label(cell) << ": " << cell["stability"].dump());
    CHECK(cell["status"] == "ok");
    const Json& verdict = cell["stability"]["verdict"];
    const Integrand& f =
        test::catalog().integrand(cell["scene"]["integrand"].get<std::string>(), "test");
    CHECK((verdict == "NOT_INTEGRABLE") == (f.mean.kind == ExactSource::Kind::undefined));
    CHECK((verdict == "OK" || verdict == "NOT_INTEGRABLE" || verdict == "UNRESOLVED"));
    ++judged;
  }
  CHECK(judged == 2 * test::catalog().integrands.size());
}

TEST_CASE("the published dimension test: scrambled Sobol' meets its thresholds", "[statistical]") {
  // QuantLib's test of low-discrepancy sequences (6-definitions 19): prod (1 + c (x - 1/2)), c =
  // 0.01, N = 30031; largest log10 of the error, here of the RMSE over 32 replicates.
  const std::map<std::uint32_t, std::pair<double, double>> largest{{1000, {-3, -4.5}},
                                                                   {2000, {-2.5, -4}}};
  std::size_t judged = 0;
  const Json results = run_study("dimension", "--sampler sobol --sampler sobol-owen");
  for (const Json& cell : results["cells"]) {
    const double error = std::log10(cell["rows"][0]["rmse"].get<double>());
    const auto& [plain, scrambled] = largest.at(cell["scene"]["d"]);
    INFO(label(cell) << ": log10 RMSE " << error);
    CHECK(error <= (cell["estimator"] == "qmc" ? plain : scrambled));
    ++judged;
  }
  CHECK(judged == 4);
}
