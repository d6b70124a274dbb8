#include "plan/compose.hpp"

#include <fmt/format.h>

#include <cctype>

#include "catalog/embedded.hpp"
#include "plan/general.hpp"
#include "plan/prune.hpp"

namespace koksma {
namespace {

// CL1.2 is what every implementation has; -w keeps vector code's unused-function warnings off the
// terminal.
constexpr const char* kOptions = "-cl-std=CL1.2 -w";

// Only in the kernel's own body is the number of drawn coordinates known before every draw: as a
// function, which PoCL makes of anything large, unrolled loops still look for their subscripts, and
// Philox is there once per coordinate instead of once in four. Not for integrands with transforms
// or solvers: they spend their time elsewhere, and took up to 5 % longer.
constexpr const char* kInlinedIntegrand =
    "#if KOKSMA_UNROLLED\nstatic inline real integrand(points *p, params q, coefficients c) "
    "__attribute__((always_inline));\n#endif\n";

void append_piece(std::string& text, const SourceFile& piece) {
  text += fmt::format("#line 1 \"{}\"\n{}\n", piece.path, piece.text);
}

void append_embedded(std::string& text, const char* path) {
  append_piece(text, {path, std::string(embedded_text(path))});
}

std::string defines_source(const Plan& plan, ProgramKind kind) {
  std::string text;
  const auto define = [&](const std::string& name, std::int64_t value) {
    text += fmt::format("#define {} {}\n", name, value);
  };
  define("KOKSMA_LANES_PER_ITEM", plan.shape.lanes_per_item);
  define("KOKSMA_FP64", plan.fp64() ? 1 : 0);
  define("KOKSMA_DIM", plan.request.dim);
  const bool general = kind == ProgramKind::general;
  define("KOKSMA_UNROLLED", plan.request.dim <= kMostUnrolledDim && !general ? 1 : 0);
  // A rotated set's own points are exact; the rotation centres them.
  if (plan.coarse_coordinates) define("KOKSMA_COARSE", 1);
  if (!general) define("KOKSMA_CENTRED", plan.sampler->centred && !plan.sampler->rotated ? 1 : 0);
  if (plan.sampler->rotated) define("KOKSMA_ROTATED", 1);
  if (plan.request.centred_draws) define("KOKSMA_CENTRED_DRAWS", 1);
  define("KOKSMA_LOCAL_SIZE", plan.shape.local_size);
  if (general) return text + general_defines(plan);
  for (const auto& [name, value] : plan.sampler->defines) define(name, value);
  if (kind == ProgramKind::integrate || kind == ProgramKind::count) {
    define("KOKSMA_MOMENTS", plan.estimator->moments);
    if (plan.estimator->moments == 2)
      define("KOKSMA_SQUARES_OF", plan.estimator->second_moment == "values"       ? 0
                                  : plan.estimator->second_moment == "pair-means" ? 1
                                                                                  : 2);
    define("KOKSMA_SUM_WORDS", plan.sum_words());
    if (plan.counters) define("KOKSMA_COUNTERS", 1);
    if (plan.counters) define("KOKSMA_COUNTERS_FP64", plan.device_fp64 ? 1 : 0);
  } else {
    define("KOKSMA_WITH_INTEGRAND", kind == ProgramKind::inspect_scene ? 1 : 0);
  }
  return text;
}

// A sum piece and the kernel that adds with it, their names made those of place k.
std::string renamed_sum(const SumAlgorithm& sum, std::size_t k, bool fp64) {
  std::string before = fmt::format("#define KOKSMA_SUM_WORDS {}\n", sum.words(fp64));
  std::string after = "#undef KOKSMA_SUM_WORDS\n";
  for (const char* name : {"sum", "sum_scalar", "sum_value", "sum_init", "sum_convert", "sum_add",
                           "sum_store", "add_up"}) {
    before += fmt::format("#define {0} {0}_{1}\n", name, k);
    after += fmt::format("#undef {}\n", name);
  }
  std::string text = std::move(before);
  append_piece(text, sum.code);
  append_embedded(text, "kernels/stability/add-up.cl");
  return text + after;
}

}  // namespace

std::string params_source(const Integrand& f, const char* type) {
  std::string members, loads;
  for (std::size_t i = 0; i < f.parameters.size(); ++i) {
    members += fmt::format("  {} {};\n", type, f.parameters[i].name);
    loads += fmt::format("  q.{} = values[{}];\n", f.parameters[i].name, i);
  }
  if (f.parameters.empty()) members = fmt::format("  {} unused;\n", type);
  if (f.parameters.empty()) loads = "  q.unused = 0;\n";
  return fmt::format(
      "#line 1 \"generated: parameters of {}\"\ntypedef struct {{\n{}}} params;\n"
      "static inline params load_params(__global const {} *values) {{\n  params q;\n{}  return "
      "q;\n}}\n",
      f.name, members, type, loads);
}

std::string choices_source(const Integrand& f, const Scene& scene) {
  std::string text;
  for (std::size_t i = 0; i < f.choices.size(); ++i) {
    std::string name = fmt::format("{}_{}", f.choices[i].name, scene.choices.at(i));
    for (char& c : name)
      c = c == '-' ? '_' : static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    text += fmt::format("#define KOKSMA_{} 1\n", name);
  }
  return text;
}

void append_integrand(std::string& text, const Catalog& catalog, const Integrand& f,
                      const Scene& scene) {
  text += choices_source(f, scene);
  text += params_source(f, "scalar");
  const std::string* solver = solver_of(f, scene.choices);
  if (f.transforms.empty() && solver == nullptr) text += kInlinedIntegrand;
  if (solver != nullptr) {
    text += fmt::format("#define KOKSMA_ODE_SIZE {}\n", f.ode_size);
    const Solver& method = catalog.solver(*solver);
    if (method.adaptive)
      text += fmt::format(
          "#if KOKSMA_FP64\n#define KOKSMA_LEAST_TOLERANCE {:e}\n#else\n"
          "#define KOKSMA_LEAST_TOLERANCE {:e}f\n#endif\n",
          method.least_tolerance_fp64, method.least_tolerance_fp32);
    for (const SourceFile& part : catalog.solver_parts) append_piece(text, part);
    append_piece(text, method.code);
  }
  for (const SourceFile& part : f.parts) append_piece(text, part);
  append_piece(text, f.code);
}

std::string counting_types() {
  std::string text;
  append_embedded(text, "kernels/counting/operations.cl");
  return text;
}

ProgramSource compose_whole(const Catalog& catalog, const Plan& plan, ProgramKind kind) {
  const bool general = kind == ProgramKind::general;
  const bool counts = kind == ProgramKind::count;
  const bool integrates = kind == ProgramKind::integrate || general || counts;
  std::string text = defines_source(plan, kind);
  append_embedded(text, "kernels/prelude.cl");
  if (integrates) append_piece(text, plan.sum->code);
  const Family& family = catalog.family(plan.sampler->family);
  for (const SourceFile& part : family.parts) append_piece(text, part);
  if (general) append_embedded(text, "kernels/general/switches.cl");
  if (general)
    append_embedded(text, general_kernel(plan).c_str());
  else
    append_piece(text, family.code);
  if (plan.sampler->rotated) append_embedded(text, "kernels/rotate.cl");
  if (integrates && plan.counters) append_embedded(text, "kernels/counters.cl");
  append_embedded(text, "kernels/centred.cl");
  if (counts) append_embedded(text, "kernels/counting/points.cl");
  if (kind != ProgramKind::inspect) {
    for (const std::string& name : plan.integrand->transforms)
      append_piece(text, catalog.transform(name).code);
    append_integrand(text, catalog, *plan.integrand, plan.cell.scene);
  }
  append_embedded(text, general      ? "kernels/general/integrate.cl"
                        : counts     ? "kernels/counting/count.cl"
                        : integrates ? "kernels/integrate.cl"
                                     : "kernels/inspect.cl");
  const std::string scene = plan.integrand == nullptr ? "points" : plan.integrand->name;
  return {fmt::format("the {}kernel of {} with {}", general ? "general " : "", scene,
                      plan.sampler->name),
          std::move(text),
          plan.relaxed_math ? fmt::format("{} {}", kOptions, kRelaxedMathOption) : kOptions};
}

ProgramSource compose(const Catalog& catalog, const Plan& plan, ProgramKind kind) {
  ProgramSource source = compose_whole(catalog, plan, kind);
  source.text = pruned(source.text).text;
  return source;
}

ProgramSource compose_preparation(const Family& family, const std::string& piece,
                                  std::uint32_t local_size) {
  const std::string path = fmt::format("kernels/points/prepare/{}.cl", piece);
  std::string text =
      "#define KOKSMA_LANES_PER_ITEM 1\n#define KOKSMA_FP64 0\n#define KOKSMA_DIM 2\n"
      "#define KOKSMA_CENTRED 0\n";
  append_embedded(text, "kernels/prelude.cl");
  for (const SourceFile& part : family.parts) append_piece(text, part);
  for (const SourceFile& code : family.preparations)
    if (code.path == path) append_piece(text, code);
  return {fmt::format("the preparation {}", path), std::move(text),
          fmt::format("{} -DKOKSMA_LOCAL_SIZE={}", kOptions, local_size)};
}

ProgramSource counting_program(const Catalog& catalog, const Plan& plan) {
  Plan counting = plan;
  counting.counters = true;
  return compose(catalog, counting, ProgramKind::integrate);
}

ProgramSource inspect_program(const Catalog& catalog, const Plan& plan, bool with_integrand) {
  return compose(catalog, plan, with_integrand ? ProgramKind::inspect_scene : ProgramKind::inspect);
}

ProgramSource exact_program(const Integrand& integrand, const Scene& scene) {
  std::string text = "#define KOKSMA_EXACT 1\n#pragma OPENCL EXTENSION cl_khr_fp64 : enable\n";
  using Kind = ExactSource::Kind;
  if (integrand.mean.kind == Kind::formula) text += "#define KOKSMA_EXACT_MEAN 1\n";
  if (integrand.variance.kind == Kind::formula) text += "#define KOKSMA_EXACT_VARIANCE 1\n";
  if (integrand.mean_abs.kind == Kind::formula) text += "#define KOKSMA_EXACT_MEAN_ABS 1\n";
  if (integrand.variation.kind == Kind::formula) text += "#define KOKSMA_EXACT_VARIATION 1\n";
  if (integrand.discrete.kind == Kind::formula) text += "#define KOKSMA_EXACT_DISCRETE 1\n";
  if (integrand.bound.kind == Kind::formula) text += "#define KOKSMA_EXACT_BOUND 1\n";
  if (integrand.stiffness.kind == Kind::formula) text += "#define KOKSMA_EXACT_STIFFNESS 1\n";
  if (integrand.dimension_order) text += "#define KOKSMA_EXACT_ORDER 1\n";
  if (!integrand.coefficients.empty())
    text += fmt::format("#define KOKSMA_EXACT_SETUP {}\n", integrand.coefficients.size());
  text += choices_source(integrand, scene);
  text += params_source(integrand, "double");
  for (const SourceFile& part : integrand.parts) append_piece(text, part);
  append_piece(text, integrand.code);
  append_embedded(text, "kernels/exact.cl");
  return {fmt::format("the exact values of {}", integrand.name), std::move(text), kOptions};
}

ProgramSource quality_program(const std::string& piece, bool fp64, const LaunchShape& shape) {
  // The dimension is an argument of these kernels; the prelude asks for one and only unrolls by it.
  std::string text = fmt::format(
      "#define KOKSMA_LANES_PER_ITEM {}\n#define KOKSMA_FP64 {}\n#define KOKSMA_DIM 1\n"
      "#define KOKSMA_CENTRED 0\n#define KOKSMA_LOCAL_SIZE {}\n",
      shape.lanes_per_item, fp64 ? 1 : 0, shape.local_size);
  append_embedded(text, "kernels/prelude.cl");
  append_embedded(text, fmt::format("kernels/quality/{}.cl", piece).c_str());
  return {fmt::format("the quality kernels of {}.cl", piece), std::move(text), kOptions};
}

ProgramSource calibration_program(const LaunchShape& shape) {
  std::string text = fmt::format(
      "#define KOKSMA_LANES_PER_ITEM {}\n#define KOKSMA_FP64 0\n#define KOKSMA_DIM 1\n"
      "#define KOKSMA_CENTRED 1\n#define KOKSMA_LOCAL_SIZE {}\n",
      shape.lanes_per_item, shape.local_size);
  append_embedded(text, "kernels/prelude.cl");
  append_embedded(text, "kernels/calibrate.cl");
  return {"the calibration kernel", std::move(text), kOptions};
}

ProgramSource self_test_program(const std::string& piece,
                                const std::vector<const SumAlgorithm*>& sums, Precision precision,
                                std::uint32_t lanes_per_item, const std::string& options) {
  const bool fp64 = precision == Precision::fp64;
  std::string text = fmt::format(
      "#define KOKSMA_LANES_PER_ITEM {}\n#define KOKSMA_FP64 {}\n#define KOKSMA_DIM 1\n"
      "#define KOKSMA_CENTRED 0\n",
      lanes_per_item, fp64 ? 1 : 0);
  append_embedded(text, "kernels/prelude.cl");
  for (std::size_t k = 0; k < sums.size(); ++k) text += renamed_sum(*sums[k], k, fp64);
  append_embedded(text, fmt::format("kernels/stability/{}.cl", piece).c_str());
  return {fmt::format("the self-test {}.cl", piece), std::move(text),
          options.empty() ? std::string(kOptions) : fmt::format("{} {}", kOptions, options)};
}

}  // namespace koksma
