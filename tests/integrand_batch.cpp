#include "tests/integrand_batch.hpp"

#include <fmt/format.h>

#include <map>
#include <regex>
#include <set>

#include "catalog/embedded.hpp"
#include "plan/compose.hpp"

namespace koksma::test {
namespace {

constexpr std::size_t kPoints = 16;

// The points slot of a batch: coordinates that are given.
constexpr const char* kGivenPoints =
    "typedef struct { __global const scalar *x; uint dim; } points;\n"
    "static inline real points_next(points *p) { return load_lanes(p->x + 16 * p->dim++); }\n";

// What the piece defines at file scope: functions, constants and types, or macros.
std::set<std::string> names(const std::string& code, const std::string& pattern) {
  const std::regex expression(pattern);
  std::set<std::string> found;
  for (std::sregex_iterator i(code.begin(), code.end(), expression), end; i != end; ++i)
    found.insert((*i)[1]);
  return found;
}

// The piece with its own names made those of the k-th, so that others may have the same.
std::string renamed(const Integrand& f, std::string source, std::size_t k) {
  // Functions, whatever a plan makes of them: PoCL has three copies of a kernel's body, and all
  // integrands in each take minutes to build.
  const std::string inlined = "always_inline", defined = "static inline real integrand(";
  if (const auto at = source.find(inlined); at != std::string::npos)
    source.replace(at, inlined.size(), "noinline");
  else
    source.replace(source.find(defined), defined.size(),
                   "__attribute__((noinline)) static real integrand(");
  source.insert(0, 1, '\n');  // names begin lines
  std::set<std::string> own = names(source, R"(\nstatic [^;{=]*?(\w+)\()");
  own.merge(names(source, R"(\n__constant \w+ (\w+))"));
  own.insert({"integrand", "params", "load_params"});
  if (f.ode_size > 0) own.insert("ode");
  std::string before, after;
  for (const std::string& name : own) {
    before += fmt::format("#define {0} {0}_{1}\n", name, k);
    after += fmt::format("#undef {}\n", name);
  }
  for (const std::string& name : names(source, R"(\n *#define (\w+))"))
    after += fmt::format("#undef {}\n", name);
  return before + source + after;
}

// The program, and for each item the one of its functions that computes it: scenes that differ in
// parameters alone share one, as parameters are arguments.
struct BatchProgram {
  ProgramSource source;
  std::vector<std::uint32_t> function;
};

BatchProgram batch_program(const std::vector<BatchItem>& items, bool fp64, std::uint32_t lanes) {
  const std::uint32_t dim = items.front().scene.dim;
  std::string text = fmt::format(
      "#define KOKSMA_LANES_PER_ITEM {}\n#define KOKSMA_FP64 {}\n#define KOKSMA_DIM {}\n"
      "#define KOKSMA_UNROLLED {}\n#define KOKSMA_CENTRED 1\n{}\n{}",
      lanes, fp64 ? 1 : 0, dim, dim <= kMostUnrolledDim ? 1 : 0,
      embedded_text("kernels/prelude.cl"), kGivenPoints);
  text += embedded_text("kernels/centred.cl");
  std::set<std::string> transforms;
  std::string pieces, calls;
  std::map<std::string, std::uint32_t> seen;
  std::vector<std::uint32_t> function;
  for (const BatchItem& item : items) {
    const Integrand& f = catalog().integrand(item.scene.integrand, "test");
    std::string code;
    append_integrand(code, catalog(), f, item.scene);
    const auto [place, is_new] = seen.emplace(code, seen.size());
    const std::uint32_t k = function.emplace_back(place->second);
    if (!is_new) continue;
    for (const std::string& name : f.transforms)
      if (transforms.insert(name).second) text += catalog().transform(name).code.text;
    pieces += renamed(f, code, k);
    calls += fmt::format(
        "  if (function == {0}) y = integrand_{0}(&p, load_params_{0}(values), c);\n", k);
  }
  text += pieces +
          "__kernel void evaluate(uint function, __global const scalar *x, __global const scalar "
          "*values,\n"
          "                       coefficients c, __global scalar *out, __global uint *drawn) {\n"
          "  const uint lane = (uint)get_global_id(0) * KOKSMA_LANES_PER_ITEM;\n"
          "  points p;\n  p.x = x + lane;\n  p.dim = 0;\n  real y = R(0.0);\n" +
          calls + "  store_lanes(y, out + lane);\n  drawn[get_global_id(0)] = p.dim;\n}\n";
  return {{"a batch of integrands", std::move(text), "-cl-std=CL1.2 -w"}, std::move(function)};
}

BatchValue evaluate_one(cl::Kernel& kernel, std::uint32_t function, const BatchItem& item,
                        bool fp64, std::uint32_t lanes) {
  const Integrand& f = catalog().integrand(item.scene.integrand, "test");
  ExactValues exact;  // its coefficients, which most have not: half a second less
  if (!f.coefficients.empty()) exact = compute_exact(device(), f, item.scene);
  const cl::Buffer x = device().upload_reals(item.x, fp64);
  const cl::Buffer values = device().upload_reals(item.scene.parameters, fp64);
  const cl::Buffer coefficients = device().upload_reals(exact.coefficients, fp64);
  const cl::Buffer out = device().allocate(kPoints * 8), drawn = device().allocate(kPoints * 4);
  kernel.setArg(0, cl_uint{function});
  kernel.setArg(1, x);
  kernel.setArg(2, values);
  kernel.setArg(3, coefficients);
  kernel.setArg(4, out);
  kernel.setArg(5, drawn);
  cl::CommandQueue& queue = device().queue();
  queue.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(kPoints / lanes), cl::NDRange(1));
  BatchValue result;
  result.f.resize(kPoints);
  if (fp64) {
    queue.enqueueReadBuffer(out, CL_TRUE, 0, kPoints * sizeof(double), result.f.data());
  } else {
    std::vector<float> narrow(kPoints);
    queue.enqueueReadBuffer(out, CL_TRUE, 0, kPoints * sizeof(float), narrow.data());
    result.f.assign(narrow.begin(), narrow.end());
  }
  queue.enqueueReadBuffer(drawn, CL_TRUE, 0, sizeof(cl_uint), &result.drawn);
  return result;
}

}  // namespace

std::vector<BatchValue> evaluate(const std::vector<BatchItem>& items, Precision precision,
                                 std::uint32_t lanes) {
  const bool fp64 = precision == Precision::fp64;
  const BatchProgram batch = batch_program(items, fp64, lanes);
  cl::Kernel kernel(device().build(batch.source).program, "evaluate");
  std::vector<BatchValue> result;
  for (std::size_t k = 0; k < items.size(); ++k)
    result.push_back(evaluate_one(kernel, batch.function[k], items[k], fp64, lanes));
  return result;
}

}  // namespace koksma::test
