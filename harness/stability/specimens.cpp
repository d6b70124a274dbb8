#include "stability/specimens.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "catalog/embedded.hpp"

namespace koksma {
namespace {

constexpr const char* kTerms = "terms";
constexpr const char* kIndices = "indices";
// The multiplier of the rrmxmx mixer (P. Evensen, 2018): odd, so multiplying is a bijection.
constexpr std::uint64_t kIndexMix = 0x9FB21C651E98DF25U;

SourceFile piece(const std::string& path, const std::string& before = "") {
  return {path, before + std::string(embedded_text(path.c_str()))};
}

Integrand specimen_integrand(const char* name, SourceFile code,
                             const std::vector<std::string>& parameters) {
  Integrand f;
  f.name = name;
  f.exact_operations = true;
  for (const std::string& parameter : parameters) f.parameters.push_back({parameter, "", 0, 0, 0});
  f.max_dim = 2;
  f.code = std::move(code);
  return f;
}

Sampler index_sampler() {
  Sampler s;
  s.name = kIndices;
  s.family = kIndices;
  s.centred = true;  // no set of coordinates that N could exhaust
  s.max_log2_n = 63;
  s.max_dim = 1;
  s.precisions = {"fp64"};
  return s;
}

SumAlgorithm index_sum() {
  SumAlgorithm s;
  s.name = kIndices;
  s.words_fp32 = s.words_fp64 = 4;
  s.needs_fp64 = true;  // a double has the 64 bits of an index
  s.order_free = true;
  s.code = piece("kernels/stability/index-sums.cl",
                 fmt::format("#define KOKSMA_INDEX_MIX {:#x}ul\n", kIndexMix));
  return s;
}

Cell specimen_cell(const Catalog& catalog, std::uint64_t n) {
  const auto one_mean = std::find_if(
      catalog.estimators.begin(), catalog.estimators.end(),
      [](const Estimator& e) { return e.moments == 1 && e.replicates_per_estimate == 1; });
  Cell cell;
  cell.estimator = one_mean->name;
  cell.n = {n};
  cell.seed = 1;
  return cell;
}

}  // namespace

Catalog with_terms(const Catalog& catalog) {
  Catalog result = catalog;
  result.integrands.push_back(specimen_integrand(kTerms, piece("kernels/stability/terms.cl"),
                                                 {"offset", "slope", "swing", "absolute"}));
  return result;
}

Catalog with_indices(const Catalog& catalog) {
  Catalog result = catalog;
  result.integrands.push_back(
      specimen_integrand(kIndices, piece("kernels/stability/index-integrand.cl"), {}));
  Family family;
  family.name = kIndices;
  family.code = piece("kernels/stability/index-points.cl");
  result.families.push_back(std::move(family));
  result.samplers.push_back(index_sampler());
  result.sums.push_back(index_sum());
  return result;
}

Cell terms_cell(const Catalog& with_terms, const std::string& sum, Precision precision,
                std::uint64_t n) {
  const auto independent =
      std::find_if(with_terms.samplers.begin(), with_terms.samplers.end(),
                   [](const Sampler& s) { return declares(s.validity, "iid"); });
  Cell cell = specimen_cell(with_terms, n);
  cell.scene = {kTerms, 2, {0, 0, 0, 0}, {}, kTerms};
  cell.sampler = independent->name;
  cell.precision = precision;
  cell.sum = sum;
  return cell;
}

Cell index_cell(const Catalog& with_indices, std::uint64_t n) {
  Cell cell = specimen_cell(with_indices, n);
  cell.scene = {kIndices, 1, {}, {}, kIndices};
  cell.sampler = kIndices;
  cell.precision = Precision::fp64;
  cell.sum = kIndices;
  return cell;
}

std::uint64_t index_mix(std::uint64_t i) {
  for (int round = 0; round < 2; ++round) i = (i ^ i >> 32U) * kIndexMix;
  return i ^ i >> 32U;
}

}  // namespace koksma
