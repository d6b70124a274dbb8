// The solvers of kernels/solvers/: stability functions, orders, properties, and what they make of
// Robertson's problem. Tests iterate over the catalog: a new solver is tested by being there.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <complex>
#include <vector>

#include "catalog/embedded.hpp"
#include "estimate/measure.hpp"
#include "tests/integrand_batch.hpp"
#include "tests/support.hpp"

using namespace koksma;

namespace {

constexpr std::size_t kSolverLanes = 16;
using Lanes = std::array<double, kSolverLanes>;

// Two equations, by `kind`: 0: y' = z y and y' = z/2 y, z given per lane; 1: y' = -2 t y^2 and
// v' = v y (1 + t^2) cos t from t = 1/4, y = 1 / (1 + t^2), v = exp(sin t); 2: y' = 1 + y^2 twice,
// y = tan t.
constexpr const char* kProblems = R"(
struct ode { real rate; uint kind; };
static inline void ode_rhs(const ode *m, real t, const real *y, real *f) {
  const real grown = fma(t, t, R(1.0)) * cos(t);
  f[0] = m->kind == 0 ? m->rate * y[0] : m->kind == 1 ? R(-2.0) * t * y[0] * y[0] : fma(y[0], y[0], R(1.0));
  f[1] = m->kind == 0 ? R(0.5) * m->rate * y[1] : m->kind == 1 ? grown * y[0] * y[1] : fma(y[1], y[1], R(1.0));
}
static inline void ode_jacobian(const ode *m, real t, const real *y, real *j) {
  const real grown = fma(t, t, R(1.0)) * cos(t);
  j[0] = m->kind == 0 ? m->rate : m->kind == 1 ? R(-4.0) * t * y[0] : R(2.0) * y[0];
  j[1] = R(0.0);
  j[2] = m->kind == 1 ? grown * y[1] : R(0.0);
  j[3] = m->kind == 0 ? R(0.5) * m->rate : m->kind == 1 ? grown * y[0] : R(2.0) * y[1];
}
static inline void ode_time_derivative(const ode *m, real t, const real *y, real *g) {
  const real grown = R(2.0) * t * cos(t) - fma(t, t, R(1.0)) * sin(t);
  g[0] = m->kind == 1 ? R(-2.0) * y[0] * y[0] : R(0.0);
  g[1] = m->kind == 1 ? grown * y[0] * y[1] : R(0.0);
}
)";

// All solvers in one program, told apart by the number that is appended to what they define.
ProgramSource program(bool fp64) {
  std::string text = fmt::format(
      "#define KOKSMA_LANES_PER_ITEM {}\n#define KOKSMA_FP64 {}\n#define KOKSMA_DIM 1\n"
      "#define KOKSMA_UNROLLED 1\n#define KOKSMA_CENTRED 1\n#define KOKSMA_ODE_SIZE 2\n{}\n",
      kSolverLanes, fp64 ? 1 : 0, embedded_text("kernels/prelude.cl"));
  // Only one solver is adaptive, so that one least tolerance serves for all.
  for (const Solver& solver : test::catalog().solvers)
    if (solver.adaptive)
      text += fmt::format("#define KOKSMA_LEAST_TOLERANCE (KOKSMA_FP64 ? {:e} : {:e})\n",
                          solver.least_tolerance_fp64, solver.least_tolerance_fp32);
  for (const SourceFile& part : test::catalog().solver_parts) text += part.text;
  text += kProblems;
  std::string calls;
  for (std::size_t k = 0; k < test::catalog().solvers.size(); ++k) {
    text += fmt::format("#define ode_solve ode_solve_{}\n{}\n#undef ode_solve\n", k,
                        test::catalog().solvers[k].code.text);
    calls += fmt::format(
        "  if (solver == {0}) ode_solve_{0}(&m, t0, t1, steps, (real)tolerance, y);\n", k);
  }
  text +=
      "__kernel void solve(uint solver, uint kind, __global const scalar *in, uint steps,\n"
      "                    scalar tolerance, __global scalar *out) {\n"
      "  ode m;\n  m.rate = load_lanes(in);\n  m.kind = kind;\n"
      "  const real t1 = load_lanes(in + KOKSMA_LANES_PER_ITEM);\n"
      "  const real t0 = kind == 1 ? R(0.25) : R(0.0);\n  real y[2];\n"
      "  y[0] = kind == 0 ? R(1.0) : kind == 1 ? R(1.0) / R(1.0625) : R(0.0);\n"
      "  y[1] = kind == 1 ? exp(sin(t0)) : y[0];\n" +
      calls + "  store_lanes(y[0], out);\n  store_lanes(y[1], out + KOKSMA_LANES_PER_ITEM);\n}\n";
  return {"the solvers", std::move(text), "-cl-std=CL1.2 -w"};
}

struct SolverRun {
  std::size_t solver = 0;
  unsigned kind = 0, steps = 1;
  double tolerance = 1e30;  // adaptive solvers take one step
  Lanes rates{}, ends{};
};

// y and v at the ends.
std::array<Lanes, 2> solve(const SolverRun& run, bool fp64 = true) {
  static std::array<cl::Kernel, 2> kernels;  // by precision; built once
  cl::Kernel& kernel = kernels[fp64 ? 1 : 0];
  if (!kernel()) kernel = cl::Kernel(test::device().build(program(fp64)).program, "solve");
  std::vector<double> in(run.rates.begin(), run.rates.end());
  in.insert(in.end(), run.ends.begin(), run.ends.end());
  const cl::Buffer buffer = test::device().upload_reals(in, fp64);
  const cl::Buffer out = test::device().allocate(2 * kSolverLanes * sizeof(double));
  kernel.setArg(0, static_cast<cl_uint>(run.solver));
  kernel.setArg(1, cl_uint{run.kind});
  kernel.setArg(2, buffer);
  kernel.setArg(3, cl_uint{run.steps});
  if (fp64)
    kernel.setArg(4, run.tolerance);
  else
    kernel.setArg(4, static_cast<float>(run.tolerance));
  kernel.setArg(5, out);
  cl::CommandQueue& queue = test::device().queue();
  queue.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(1), cl::NDRange(1));
  std::array<Lanes, 2> result{};
  if (fp64) {
    queue.enqueueReadBuffer(out, CL_TRUE, 0, sizeof(result), result.data());
  } else {
    std::array<float, 2 * kSolverLanes> narrow{};
    queue.enqueueReadBuffer(out, CL_TRUE, 0, sizeof(narrow), narrow.data());
    for (std::size_t i = 0; i < 2 * kSolverLanes; ++i)
      result[i / kSolverLanes][i % kSolverLanes] = narrow[i];
  }
  return result;
}

template <typename T>
T polynomial(const std::vector<double>& coefficients, T z) {
  T value = 0;
  for (std::size_t k = coefficients.size(); k-- > 0;) value = value * z + coefficients[k];
  return value;
}

template <typename T>
T growth(const Solver& solver, T z) {
  return polynomial(solver.numerator, z) / polynomial(solver.denominator, z);
}

Lanes filled(double value) {
  Lanes lanes;
  lanes.fill(value);
  return lanes;
}

// Of both components of problem 1 at t.
double error_at(const std::array<Lanes, 2>& y, std::size_t lane, double t) {
  return std::max(std::fabs(y[0][lane] - 1 / (1 + t * t)),
                  std::fabs(y[1][lane] - std::exp(std::sin(t))));
}

// An explicit solver of a stiff problem may leave the range in its lane.
bool same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

const std::vector<Solver>& solvers() { return test::catalog().solvers; }

}  // namespace

TEST_CASE("one step of every solver on y' = z y gives its stability function to rounding",
          "[device]") {
  REQUIRE(solvers().size() >= 7);
  const Lanes z{-1e6, -1e4, -1e3, -100, -50,  -10,   -5,    -3,
                -2.5, -2,   -1,   -0.5, -0.1, -1e-3, 0.125, 0.3};
  for (std::size_t k = 0; k < solvers().size(); ++k)
    for (const bool fp64 : {true, false}) {
      const auto y = solve({k, 0, 1, 1e30, z, filled(1)}, fp64);
      for (std::size_t l = 0; l < kSolverLanes; ++l)
        for (const std::size_t half : {0U, 1U}) {
          // The arithmetic is that of the lane's z.
          const double rate = fp64 ? z[l] : static_cast<double>(static_cast<float>(z[l]));
          const double expected = growth(solvers()[k], half == 0 ? rate : rate / 2);
          INFO(solvers()[k].name << (fp64 ? " fp64" : " fp32") << " z = " << rate << ": "
                                 << y[half][l] << ", R(z) = " << expected);
          CHECK(std::fabs(y[half][l] - expected) <=
                (fp64 ? 5e-14 : 2e-5) * std::max(1.0, std::fabs(expected)));
        }
    }
}

TEST_CASE("every solver has its order on a nonlinear problem that depends on time", "[device]") {
  for (std::size_t k = 0; k < solvers().size(); ++k) {
    const Solver& solver = solvers()[k];
    double order = 0;
    if (solver.adaptive) {
      // One step and one of half its length: the local error is of one order more.
      Lanes ends = filled(0.25 + 0x1p-6);
      ends[1] = 0.25 + 0x1p-7;
      const auto y = solve({k, 1, 1, 1e30, {}, ends});
      order = std::log2(error_at(y, 0, ends[0]) / error_at(y, 1, ends[1])) - 1;
    } else {
      const auto coarse = solve({k, 1, 64, 1, {}, filled(1)});
      const auto fine = solve({k, 1, 128, 1, {}, filled(1)});
      order = std::log2(error_at(coarse, 0, 1) / error_at(fine, 0, 1));
    }
    INFO(solver.name << ": measured " << order);
    CHECK(order == Approx(solver.order).margin(0.1));
  }
}

TEST_CASE("the error of adaptive solvers follows the tolerance", "[device]") {
  std::size_t adaptive = 0;
  for (std::size_t k = 0; k < solvers().size(); ++k) {
    if (!solvers()[k].adaptive) continue;
    ++adaptive;
    double last = 1;
    for (const double tolerance : {1e-3, 1e-6, 1e-9, 1e-12}) {
      const double error = error_at(solve({k, 1, 1, tolerance, {}, filled(1)}), 0, 1);
      INFO(solvers()[k].name << " tolerance " << tolerance << ": " << error);
      CHECK(error <= 10 * tolerance);
      CHECK(error <= last / 10);
      last = error;
    }
  }
  CHECK(adaptive >= 1);
}

TEST_CASE("solvers are A-stable and L-stable exactly where they say so", "[device]") {
  for (std::size_t k = 0; k < solvers().size(); ++k) {
    const Solver& solver = solvers()[k];
    INFO(solver.name);
    // |R| <= 1 on the left half-plane: on its border, and inside, where a pole would show.
    double largest = 0;
    for (int i = 0; i <= 600; ++i)
      for (int angle = 0; angle <= 90; angle += 5) {
        const double radius = std::pow(10.0, -3 + i * 0.015);
        const double phase = (90.0 + angle) * std::acos(-1.0) / 180;
        largest = std::max(largest, std::abs(growth(solver, std::polar(radius, phase))));
      }
    CHECK((largest <= 1 + 1e-12) == declares(solver.properties, "A-stable"));
    const auto y = solve({k, 0, 1, 1e30, filled(-1e8), filled(1)});
    CHECK((std::fabs(y[0][0]) < 1e-6 && declares(solver.properties, "A-stable")) ==
          declares(solver.properties, "L-stable"));
  }
}

TEST_CASE("the value of a lane does not depend on its neighbours, to the last bit", "[device]") {
  Lanes rates{}, ends{};
  for (std::size_t l = 0; l < kSolverLanes; ++l) {
    rates[l] = -std::pow(10.0, 0.4 * static_cast<double>(l));
    ends[l] = 0.3 + 0.17 * static_cast<double>(l);
  }
  for (std::size_t k = 0; k < solvers().size(); ++k)
    for (const unsigned kind : {0U, 1U}) {
      const auto mixed = solve({k, kind, 23, 1e-6, rates, ends});
      for (std::size_t l = 0; l < kSolverLanes; ++l) {
        const auto alone = solve({k, kind, 23, 1e-6, filled(rates[l]), filled(ends[l])});
        INFO(solvers()[k].name << " problem " << kind << " lane " << l);
        CHECK((same(mixed[0][l], alone[0][l]) && same(mixed[1][l], alone[1][l])));
      }
    }
}

TEST_CASE("a step without a solution ends as NaN in its lane and leaves the others alone",
          "[device]") {
  // y' = 1 + y^2: no implicit step of 10 has a real solution, and the true one ends at pi/2.
  Lanes ends = filled(0.125);
  for (std::size_t l = 0; l < kSolverLanes; l += 2) ends[l] = 10;
  for (std::size_t k = 0; k < solvers().size(); ++k) {
    const Solver& solver = solvers()[k];
    const auto mixed = solve({k, 2, 1, 1e-3, {}, ends});
    const auto alone = solve({k, 2, 1, 1e-3, {}, filled(0.125)});
    for (std::size_t l = 0; l < kSolverLanes; ++l) {
      INFO(solver.name << " lane " << l << ": " << mixed[0][l]);
      if (l % 2 == 1) {
        CHECK(mixed[0][l] == alone[0][l]);
        CHECK(mixed[0][l] == Approx(std::tan(0.125)).epsilon(0.03));
      } else if (solver.denominator.size() > 1) {
        CHECK(std::isnan(mixed[0][l]));
      }
    }
  }
}

TEST_CASE("known moments of numerical solutions of the test equation are met", "[device]") {
  // Mean and variance of R(-z)^100, z uniform in (0, 100), each by two quadratures at 60 digits.
  struct Known {
    const char* solver;
    double mean, variance;
  };
  const Known known[] = {
      {"backward-euler", 1.010101010101010101010e-4, 5.024105324090096366778e-5},
      {"radau-iia-2", 9.999996710044593844431e-5, 4.998999793696540309027e-5},
      {"trapezoid", 3.295172439551177473564e-3, 7.322856499820660504798e-5},
      {"explicit-euler", 3.587841760995021880013e197, INFINITY},
      {"rk4", INFINITY, INFINITY},  // 4.485e657
  };
  const Integrand& f = test::catalog().integrand("dahlquist", "test");
  for (const Known& row : known) {
    const Scene scene = parse_scene(
        test::catalog(), fmt::format("dahlquist:rate=1e4,steps=100,solver={}", row.solver), "test");
    const ExactValues exact = compute_exact(test::device(), f, scene);
    INFO(row.solver);
    CHECK(exact.discrete_overflows == std::isinf(row.variance));
    if (std::isfinite(row.mean)) {
      REQUIRE(exact.discrete_mean);
      CHECK(*exact.discrete_mean == Approx(row.mean).epsilon(1e-13));
    } else {
      CHECK_FALSE(exact.discrete_mean);
    }
    if (std::isfinite(row.variance)) {
      REQUIRE(exact.discrete_variance);
      CHECK(*exact.discrete_variance == Approx(row.variance).epsilon(1e-13));
    }
  }
}

TEST_CASE("sampled means of numerical solutions meet their moments where these are known",
          "[statistical]") {
  // 32 replicates, 8 standard errors: false alarm below 1e-8 per solver (Student t).
  std::size_t met = 0;
  for (const Solver& solver : solvers()) {
    const std::string scene = fmt::format("dahlquist:rate=20,steps=5,solver={}", solver.name);
    PreparedCell prepared(test::catalog(), test::device(), test::device(),
                          make_plan(test::catalog(), test::cell(scene, "sobol-owen", 1 << 10, 32),
                                    test::device().facts()));
    const auto& mean = prepared.exact().discrete_mean;
    CHECK(mean.has_value() != solver.adaptive);
    if (!mean) continue;
    const Row row = prepared.run_row(1 << 10);
    INFO(scene << ": " << *row.estimate.value << ", discrete mean " << *mean);
    CHECK(std::fabs(*row.estimate.value - *mean) <= 8 * *row.estimate.standard_error);
    ++met;
  }
  CHECK(met >= 6);
}

TEST_CASE("L-stable solvers meet the reference of Robertson's problem to their tolerance in fp64",
          "[device]") {
  // Gauss-Legendre of 6 points in the random rate leaves 1e-15 (the entry's checks agree to that).
  constexpr std::array<double, 6> x{0.033765242898423986094, 0.16939530676686774317,
                                    0.38069040695840154568,  0.61930959304159845432,
                                    0.83060469323313225683,  0.96623475710157601391};
  constexpr std::array<double, 6> weight{0.08566224618958517252, 0.18038078652406930378,
                                         0.23395696728634552369, 0.23395696728634552369,
                                         0.18038078652406930378, 0.08566224618958517252};
  constexpr double kReference = 0.28400713918894196896;  // E y3(40)
  struct Case {
    const char* values;
    double fp64, fp32;  // largest relative errors
  };
  const Case cases[] = {{"solver=rodas4,tolerance=1e-6", 1e-6, 2e-6},
                        {"solver=rodas4,tolerance=1e-8", 1e-8, 2e-6},
                        {"solver=rodas4,tolerance=1e-10", 1e-10, 2e-6},
                        {"solver=radau-iia-2,steps=160", 2e-7, 2e-6},
                        {"solver=radau-iia-2,steps=640", 3e-9, 2e-6},
                        {"solver=radau-iia-2,steps=2560", 3e-10, 5e-6},
                        {"solver=sdirk2,steps=2560", 4e-8, 1e-5}};
  std::vector<test::BatchItem> items;
  for (const Case& c : cases) {
    test::BatchItem item{
        parse_scene(test::catalog(), fmt::format("robertson:d=1,time=40,species=3,{}", c.values),
                    "test"),
        {}};
    for (std::size_t i = 0; i < 16; ++i) item.x.push_back(x[i % 6]);
    items.push_back(std::move(item));
  }
  for (const Precision precision : {Precision::fp64, Precision::fp32}) {
    const auto values = test::evaluate(items, precision, 16);
    for (std::size_t k = 0; k < items.size(); ++k) {
      double mean = 0;
      for (std::size_t i = 0; i < 6; ++i) mean += weight[i] * values[k].f[i];
      const bool fp64 = precision == Precision::fp64;
      INFO(cases[k].values << " " << precision_name(precision) << ": " << mean / kReference - 1);
      CHECK(std::fabs(mean / kReference - 1) <= (fp64 ? cases[k].fp64 : cases[k].fp32));
    }
  }
}
