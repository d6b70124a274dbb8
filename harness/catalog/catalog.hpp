// What exists: samplers, integrands, transforms, sums, estimators, read from the embedded files.
// Nothing here or below lists their names; adding a file to kernels/ or integrands/ adds an entry.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "catalog/json.hpp"

namespace koksma {

// A piece of OpenCL C; `path` is what compiler messages show.
struct SourceFile {
  std::string path;
  std::string text;
};

// A text that is given with a sampler's name; it becomes an option of the table builder.
struct SamplerParameter {
  std::string name, meaning;
  bool required = false;
  std::vector<std::string> allowed;  // empty: anything
  bool path = false;                 // of a file of the user's, whose contents decide the points
};

struct Sampler {
  std::string name, title, citation;
  std::string family;
  bool centred = false;               // coordinates (k + 1/2) 2^-m in (0,1), else k 2^-m in [0,1)
  bool replicable = false;            // has independent randomizations
  std::vector<std::string> validity;  // iid, unbiased_replicates, … (6-definitions 12)
  std::string default_estimator;
  std::string size_form;   // which N there are (catalog/sizes.hpp)
  bool extensible = true;  // the first points of a larger set are the smaller set
  unsigned max_log2_n = 0;
  std::uint32_t min_dim = 1, max_dim = 0;
  bool reads_directions = false;        // --directions replaces the built-in direction numbers
  std::vector<std::string> precisions;  // "fp32", "fp64"
  std::string rate_class;               // key into an integrand's expected rates
  std::string rotated_rate_class;  // the same with :randomize=rotate; "" where there is no theory
  bool rotated = false;            // randomized by a random shift modulo 1 of every coordinate
  std::vector<SamplerParameter> parameters;  // NAME:key=value
  std::map<std::string, double> speed;       // by precision: part of plain Sobol's coordinates/s
  std::vector<std::string> properties;
  Json options;                        // for the family's table builder
  std::map<std::string, int> defines;  // structure of the kernel
  Json known_answers;
};

struct Family {
  std::string name, title, citation;
  SourceFile code;
  std::vector<SourceFile> parts;         // come before the code
  std::vector<SourceFile> preparations;  // kernels that compute point sets beforehand
};

struct Parameter {
  std::string name, meaning;
  double default_value = 0, min = 0, max = 0;
  bool integer = false;
};

// An alternative that is compiled in: the form of an expression, or the solver of an integrand that
// integrates a differential equation.
struct Choice {
  std::string name, meaning;
  std::vector<std::string> allowed;
  std::string default_value;  // among `allowed`
  bool is_solver = false;     // its values are solvers of the catalog
};

// A one-step method for y' = f(t, y), kernels/solvers/<name>.{cl,json}.
struct Solver {
  std::string name, title, citation;
  unsigned order = 1;                                         // of the global error
  bool adaptive = false;                                      // chooses its steps by a tolerance
  double least_tolerance_fp32 = 0, least_tolerance_fp64 = 0;  // smaller ones are raised to it
  // R(z), the growth of y' = λy over a step h, z = hλ: coefficients by ascending powers.
  std::vector<double> numerator, denominator;
  std::vector<std::string> properties;  // A-stable, L-stable
  SourceFile code;
};

// Where an exact quantity comes from: a function in the .cl, the mean (mean_abs of a nonnegative
// f), a constant, the values of the entry's checks, or nowhere. `undefined`: there is no mean.
struct ExactSource {
  enum class Kind { formula, mean, constant, table, none, undefined } kind = Kind::none;
  std::optional<double> value;  // of a constant
  double tolerance = 1e-13;     // relative error of a formula
  bool infinite = false;        // an infinite result is one (mean: there is none), not an overflow
  std::string source;
};

// How the fourth moment of f is known: by an estimate, because f takes 0 and 1 only, or not at all
// (infinite or unknown).
enum class FourthMoment { estimated, indicator, unknown };

// A number for one of an integrand's parameters, by its place among them.
struct ParameterValue {
  std::size_t parameter = 0;
  double value = 0;
};

// RMSE ~ N^max(at_least, constant + per_dimension / d + sum per_parameter + sum
// per_parameter_over_dimension / d) for one class of samplers, and where it may gate.
struct ExpectedRate {
  double constant = 0, per_dimension = 0;
  std::vector<ParameterValue> per_parameter;                 // factors of the parameters
  std::vector<ParameterValue> per_parameter_over_dimension;  // the same, of parameter / d
  std::optional<double> at_least;
  std::string source;
  std::optional<std::uint32_t> gate_max_d;
  double gate_tolerance = 0;           // around the rate, or
  std::optional<double> gate_at_most;  // one-sided: a slope that is steep enough
  std::vector<ParameterValue> gate_parameters_at_most;
  bool log_correction = false;
};

struct Integrand {
  std::string name, title, citation;
  std::string smoothness;  // key into integrands/classes.json
  bool periodic = false, exact_operations = false, nonnegative = false;
  std::vector<Parameter> parameters;
  std::vector<Choice> choices;
  std::uint32_t ode_size = 0;  // equations that a sample solves; 0: none
  std::uint32_t min_dim = 1, max_dim = 1, default_dim = 1;
  std::vector<std::string> coefficients, transforms;
  bool dimension_order = false;  // the .cl says which dimension of the points each draw takes
  bool all_coordinates = false;  // keeps all coordinates of a sample in private memory
  double ulps_fp32 = 8, ulps_fp64 = 8;  // largest error of one evaluation
  ExactSource mean, variance, mean_abs;
  ExactSource variation;  // of Hardy and Krause, anchored at 1
  ExactSource discrete;   // moments of the numerical solution
  ExactSource bound;      // sup |f| of the true solution
  ExactSource stiffness;  // largest h |λ|
  FourthMoment fourth_moment = FourthMoment::estimated;
  std::map<std::string, ExpectedRate> expected;  // by sampler rate class
  Json checks, sample_checks;
  Json stability;                 // cases of the stability suite
  bool users_own = false;         // given on the command line: no test of the project has seen it
  std::vector<SourceFile> parts;  // come before the code
  SourceFile code;
};

// The solver among a scene's choices, which are in the order of the entry; nullptr if there is
// none.
const std::string* solver_of(const Integrand& integrand, const std::vector<std::string>& choices);

// The text of its pieces: the parts, then its own code.
std::string source_text(const Integrand& integrand);

struct Transform {
  std::string name, title, citation;
  SourceFile code;
};

// factor n^power_of_n u^power_of_u: part of the relative error of a sum of n terms at unit roundoff
// u.
struct RoundingTerm {
  double factor = 0, power_of_n = 0, power_of_u = 0;
};

// The weights of stored words that are digits of a long accumulator: word k counts 2^(first + k
// step).
struct DigitWeights {
  int first = 0, step = 0;
};

// Terms, in this order, whose sum an intact build returns.
struct SumKnownAnswer {
  std::vector<double> terms;
  double sum = 0;
};

struct SumAlgorithm {
  std::string name, title, citation;
  unsigned words_fp32 = 1, words_fp64 = 1;  // stored words whose exact sum is the value
  std::optional<DigitWeights> digits_fp32, digits_fp64;  // empty: every word counts as it is
  bool needs_fp64 = false;   // stores doubles; else the cell's precision
  bool compensated = false;  // rests on error-free transformations, which some build options break
  bool order_free = false;   // any order and grouping of the terms gives the same value
  std::vector<RoundingTerm> bound, estimate;  // of the error relative to the sum of |terms|
  double quantum = 0;  // terms are rounded to multiples of it; 0: they are not
  std::vector<SumKnownAnswer> self_test;
  int preference = 0;  // the default is the highest the device can run
  SourceFile code;

  unsigned words(bool fp64) const { return fp64 ? words_fp64 : words_fp32; }
  // The stored word k counts 2^word_exponent times its value.
  int word_exponent(bool fp64, unsigned k) const {
    const auto& digits = fp64 ? digits_fp64 : digits_fp32;
    return digits ? digits->first + static_cast<int>(k) * digits->step : 0;
  }
};

struct Estimator {
  std::string name, title, citation;
  std::vector<std::string> fits;  // any one of these validities; empty: every sampler
  unsigned moments = 1;
  // With two moments, what is squared: values | pair-means | pair-differences.
  std::string second_moment;
  std::string interval;  // normal | student-t | order-statistics | none
  bool replicated = false;
  // Randomizations whose median is one estimate (an odd number); 1: the estimate is the mean.
  std::uint32_t replicates_per_estimate = 1;
  std::string rate_suffix;  // of the rate class of its estimates, behind the sampler's
  std::string note;         // why other samplers do not fit
};

struct Catalog {
  std::vector<Family> families;
  std::vector<Sampler> samplers;
  std::vector<Integrand> integrands;
  std::vector<Transform> transforms;
  std::vector<Transform> filters;  // reconstruction filters: entries like those of transforms
  std::vector<SumAlgorithm> sums;
  std::vector<Solver> solvers;
  std::vector<SourceFile> solver_parts;  // what solvers share; comes before them
  std::vector<Estimator> estimators;

  // Lookups throw InputError("<where>", …) with the nearest spelling.
  // A sampler as it is written, NAME or NAME:key=value,…: keys are the entry's parameters and, for
  // deterministic sets, randomize=rotate (Cranley & Patterson 1976). The result's name is the
  // canonical spelling.
  Sampler sampler(std::string_view text, std::string_view where) const;
  const Integrand& integrand(std::string_view name, std::string_view where) const;
  const SumAlgorithm& sum(std::string_view name, std::string_view where) const;
  const Estimator& estimator(std::string_view name, std::string_view where) const;
  // Lookups by names that the catalog itself holds.
  const Family& family(std::string_view name) const;
  const Solver& solver(std::string_view name) const;
  const Transform& transform(std::string_view name) const;
};

// The schema that the embedded file of this path follows; "" where it is no entry. A test checks
// them all.
std::string_view entry_schema(std::string_view path);

// Reads the embedded entries, then reads and checks the user's integrand files (F.json beside
// F.cl). InputError for a malformed entry of the user's, an unknown class or transform, or a name
// that exists already.
Catalog load_catalog(const std::vector<std::string>& integrand_files = {});

// True when an entry's list, of properties or of validities, has the value.
bool declares(const std::vector<std::string>& values, std::string_view value);

// True when the estimator's conditions hold for the sampler (6-definitions 12).
bool fits(const Estimator& estimator, const Sampler& sampler);

// The key into an integrand's expected rates: of the sampler's means, or of what the estimator
// makes of them.
std::string rate_class(const Sampler& sampler, const Estimator& estimator);

// The names of the estimators that fit, in catalog order.
std::vector<std::string> fitting_estimators(const Catalog& catalog, const Sampler& sampler);

}  // namespace koksma
