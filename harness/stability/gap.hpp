// What precision changes, measured on identical points: the rounding of f and of its sum, and the
// grid of the coordinates, apart (page 5, section 2.8).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "catalog/catalog.hpp"
#include "device/device.hpp"
#include "estimate/floors.hpp"

namespace koksma {

// Differences of the estimates of R replicates of n samples each.
struct Difference {
  double mean = 0;
  double sd = 0;  // over the replicates
  std::uint32_t replicates = 0;
  std::uint64_t n = 0;

  // Its rms at N samples: what is common to the replicates stays, the rest averages out as N^-1/2.
  double rms_at(std::uint64_t samples) const;
};

Difference difference_of(const std::vector<double>& a, const std::vector<double>& b,
                         std::uint64_t n);

struct GapMeasurement {
  std::string reason;  // why there is none, else empty
  Difference
      evaluation;  // fp32 less fp64, both at the 23-bit coordinates and summed in the widest type
  Difference coordinates;        // fp64 at 23-bit coordinates less fp64 at 52 bits
  Difference total;              // fp32 less fp64
  std::optional<double> rmse64;  // of the fp64 estimates, where the integral is known
};

// At `n` samples of the cell's points, with its replicates and seed. Three programs. A reason where
// the device or the sampler lacks a precision, or a sum is not finite.
GapMeasurement measure_gap(const Catalog& catalog, Device& device, Device& exact_device,
                           const Cell& cell, std::uint64_t n);

// The cell's estimates less those with an exact sum (`order_free`, or the widest there is), of the
// same samples. One program.
std::optional<Difference> measure_summation(const Catalog& catalog, Device& device,
                                            Device& exact_device, const Cell& cell,
                                            std::uint64_t n);

// |E f_h − E f| of a cell whose f solves a differential equation, from twice as many steps, or a
// tenth of the tolerance, at the same points: (f_h − f_{h/2}) 2^p / (2^p − 1), p the order (L. F.
// Richardson, Phil. Trans. A 226 (1927)). An estimate: stiffness reduces orders. None for another
// f, or one that blows up. No program of its own.
std::optional<double> measure_integrator(const Catalog& catalog, Device& device,
                                         Device& exact_device, const Cell& cell, std::uint64_t n);

// Of a cell of this precision at n samples. What fp32 loses, fp64 loses at the ratio of the units:
// the same code rounds at the same places.
MeasuredFloors floors_from(const GapMeasurement& gap, Precision precision, std::uint64_t n);

}  // namespace koksma
