// Are error-free transformations intact on this device under these build options?
//
// Compensated sums compute the rounding error of an addition by subtracting what was added. Options
// that let a compiler treat floating point as real numbers turn that error into 0, and the sum into
// a naive one without a word. So nothing of the kind is believed before it was tried (page 5,
// section 2.2), with numbers that reach the device as arguments and with the sum pieces themselves.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "catalog/catalog.hpp"
#include "device/device.hpp"

namespace koksma {

// One test: what it computes, what it must give and gave.
struct EftTest {
  std::string what;
  double expected = 0, got = 0;
  bool passed = false;
};

struct EftResult {
  std::string options;  // beyond those of every program; "": strict
  Precision precision = Precision::fp64;
  std::vector<EftTest> tests;

  bool intact() const;
  // "" or "EFT_BROKEN: TwoSum(1e8, 0.375): error 0, not 0.375"; the first test that failed.
  std::string why_broken() const;
};

// The option sets of page 5, section 2.2; the first is strict.
const std::vector<std::string>& eft_option_sets();

// TwoSum, TwoProd, whether FP_CONTRACT OFF is obeyed, and each of the catalog's compensated sums:
// 2^20 times 0.1 must come out within the sum's own bound (summation.hpp) and not as the naive sum,
// and the known answers of its entry exactly. Builds one program. DeviceError; precision fp64 needs
// a device that has it.
EftResult test_error_free_transformations(const Catalog& catalog, Device& device,
                                          Precision precision, const std::string& options);

// The same by what a plan was built with, each tried once.
class EftSelfTest {
 public:
  EftSelfTest(const Catalog& catalog, Device& device) : catalog_(catalog), device_(device) {}

  // "" where the plan's sum needs no error-free transformations, or they are intact under the
  // options of its program; else the reason.
  std::string why_broken(const Plan& plan);
  // UnsupportedError with that reason.
  void require(const Plan& plan);

 private:
  const Catalog& catalog_;
  Device& device_;
  std::map<std::pair<Precision, bool>, std::string> known_;  // bool: relaxed math
};

}  // namespace koksma
