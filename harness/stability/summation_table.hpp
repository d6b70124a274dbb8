// The errors of every sum on known terms, on the device and through the integration kernel (page 5,
// section 2.1 and appendix C).
//
// One block is as long as all of N, so each of its 16 lanes adds N/16 terms one after the other:
// blocks of the usual length would hide where a sum stagnates.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "catalog/catalog.hpp"
#include "device/device.hpp"
#include "stability/eft.hpp"

namespace koksma {

struct SummationEntry {
  std::string sum;
  double error = 0;        // |S - exact| / |exact|
  double bound = 0;        // of that: the worst case times kappa
  bool exhausted = false;  // too many terms of 1 for its words: at least half must be lost
  double seconds = 0;
};

struct SummationRow {
  std::string terms;
  std::uint64_t n_per_lane = 0;
  double kappa = 1;                     // sum |terms| / |sum of terms|
  std::vector<SummationEntry> entries;  // order-free sums up to 2^24 per lane
};

// What relaxed math makes of a sum.
struct RelaxedSum {
  std::string sum;
  bool compensated = false;
  double strict_error = 0, relaxed_error = 0;  // relative, of 2^20 times 0.1 per lane
  bool changed = false;                        // the results differ in some bit
};

struct SummationTable {
  Precision precision = Precision::fp32;
  std::vector<SummationRow> rows;
  std::vector<RelaxedSum> relaxed;
  bool host_agrees = false;  // exact sums of 2^16 random terms: the device's against the host's
  bool ok = false;
  std::string why;  // the first statement that does not hold
  double seconds = 0;
};

struct SummationOptions {
  // log2 of the terms per lane: of constants (1 and 0.1), of random terms.
  std::vector<unsigned> constants{16, 20, 24, 26}, random{16, 20, 24};
  bool relaxed_math = true;
};

// Holds, of every sum that the device has: its error is within the bound that its entry states; a
// sum of more terms of 1 than its bound allows stagnates (naive stops at 2^24 in fp32); a sum whose
// bound is small does not; exact sums agree with the host's; where relaxed math changes a
// compensated sum, `relaxed_self_test` (fp32, that option) says EFT_BROKEN.
SummationTable measure_summation(const Catalog& with_terms, Device& device,
                                 const EftResult& relaxed_self_test,
                                 const SummationOptions& options = {});

}  // namespace koksma
