// Everything about a device and its compiler that decides whether sums can be believed, in one
// call.
#pragma once

#include <vector>

#include "stability/denormals.hpp"
#include "stability/eft.hpp"
#include "stability/indices.hpp"
#include "stability/invariance.hpp"
#include "stability/summation_table.hpp"

namespace koksma {

struct DeviceChecks {
  std::vector<EftResult> eft;  // every option set in every precision of the device
  bool eft_ok = false;         // intact under strict options
  std::string eft_why;
  double eft_seconds = 0;
  SummationTable summation;
  Invariance invariance;
  IndexChecks indices;
  DenormalChecks denormals;
  double seconds = 0;

  bool ok() const { return eft_ok && summation.ok && invariance.ok && indices.ok && denormals.ok; }
};

// About 60 programs. DeviceError, BuildError.
DeviceChecks run_device_checks(const Catalog& catalog, Device& device);

// One object per check: its "ok", its "why" (null where it holds), its numbers and its seconds.
Json to_json(const DeviceChecks& checks);

}  // namespace koksma
