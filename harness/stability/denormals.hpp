// What the device does with numbers below the normal range, by build options (page 5, section 2.5).
#pragma once

#include <string>
#include <vector>

#include "device/device.hpp"

namespace koksma {

struct DenormalResult {
  std::string options;  // beyond those of every program; "": strict
  Precision precision = Precision::fp64;
  bool product_flushed = false;   // of two normal numbers
  bool operand_flushed = false;   // x + 0 or 1 x is not x
  bool compared_as_zero = false;  // x > 0 is false
  bool must_keep = false;         // strict options, and the device says that it has denormals

  bool flushed() const { return product_flushed || operand_flushed || compared_as_zero; }
};

struct DenormalChecks {
  std::vector<DenormalResult> results;
  std::string fp_config_fp32, fp_config_fp64;  // CL_DEVICE_*_FP_CONFIG, "DENORM|INF_NAN|..."
  bool ok = false;                             // nothing is flushed that must be kept
  std::string why;
  double seconds = 0;
};

// Strict, -cl-denorms-are-zero and relaxed math, in the precisions that the device has.
DenormalChecks check_denormals(Device& device);

}  // namespace koksma
