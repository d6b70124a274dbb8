// Below which level does an error no longer fall with N, and what holds it there?
//
// The error of a cell is its sampling error and four terms that N does not remove (page 5, section
// 0): B the integrator of an f that solves a differential equation, C the grid of the coordinates,
// D the rounding of f, E that of the sum. Each has an estimate, on which exclusions and verdicts
// rest, and a worst-case bound, which is printed beside it. Here they come from formulas and cost
// nothing; `koksma stability` measures some and gives them in `MeasuredFloors`. All are absolute
// errors of one replicate's estimate, in the unit of the integral.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace koksma {

struct Floor {
  std::optional<double> estimate;  // rms over replicates, ≥ 0; none: unknown, `reason` says why
  std::optional<double> bound;     // worst case, to first order in u
  std::string reason;              // where it comes from, or why there is none
};

// Takes the place of the estimates, where set.
struct MeasuredFloors {
  std::optional<double> integrator;  // |E f_h − E f|, as from finer steps
  std::optional<double> coordinate;  // rms of Q − Q at finer coordinates, both in fp64
  // rms of Q − Q in fp64 at the same coordinates. Where the two runs also summed differently this
  // is D and E together, and `summation` is 0.
  std::optional<double> integrand;
  std::optional<double> summation;  // rms of Q − Q exactly summed, of the same samples
};

// What the formulas need.
struct FloorFacts {
  double unit_roundoff = 0x1p-53;  // of one evaluation of f: 2^-24 or 2^-53
  double ulps = 8;                 // largest error of one evaluation, as the entry says
  std::optional<double> mean, mean_abs, sd, variation;  // I, E|f|, σ of f, V_HK
  std::uint32_t dim = 1;
  unsigned coordinate_bits = 52;
  bool truncated = false;  // coordinates are rounded down to the grid, and the points are not on it
  bool periodic = false;
  bool ode = false;                     // f solves a differential equation
  std::optional<double> discrete_mean;  // of its numerical solution
  std::optional<double> mean_error;  // of the replicates, where it is N-independent and no chance
  double summation = 0, summation_bound = 0;  // E
  double result_rounding = 0;  // rms of the rounding of the result to double, which every sum has
  std::optional<double> reference;  // standard error of what stands for the integral
};

struct Floors {
  Floor integrator, coordinate, integrand, summation;
  std::optional<double>
      reference;  // an error cannot be seen below that of what it is taken against

  // The largest of the estimates that are known; 0: none is.
  double predicted_total() const;
  // Its name: "integrator", "coordinate", "integrand", "summation", "reference"; "": none is known,
  // or all are 0.
  std::string_view dominant() const;
  // That term; nullptr for "reference" and "".
  const Floor* dominant_floor() const;
};

// B = |E f_h − E f|. C = 2^-(b+1) Σ |E f(x_i=1) − E f(x_i=0)| where coordinates are rounded down
// (page 5, section 2.6): the sum is at most V_HK, and estimated as sqrt(12 d) σ, which a sum of
// equal linear terms has (exp-sum and sum-x on kronecker, golden, regular, halton-folded at d = 1
// and 5, measured: 0.5 to 1.3 of it; radical inverses in base 2 are exact and have none); 0 for a
// periodic f, and for coordinates that are exact or centred, whose error is of second order. D =
// kRoundingFactor u E|f|, at most ulps u E|f|. E is given.
Floors predict_floors(const FloorFacts& facts, const MeasuredFloors& measured = {});

// Estimate of D in units of u E|f|. The rms over 16 replicates of the means' gap between fp32 and
// fp64 at the same coordinates, N = 2^15 and 2^12, `sobol-owen`, every entry at d = 1, 5, 30, 100
// and its default (2026-11-24, PoCL 3.1, 204 scenes where it is not 0): median 0.29 (d = 1: 0.21,
// 5: 0.25, 30: 0.38, 100: 0.47), quartiles 0.03 and 0.8; neither ulps nor powers of d spread less.
// Of the entries at their smallest d whose curves end at it, on lattices and interlaced nets: 0.015
// to 0.7 in fp32, 0.35 to 1.4 in fp64, where the result itself is rounded. 0.2 is within a factor
// of 10 of those but `cos-prod` (0.015). Below are what rounds without bias, as products of x
// itself, since errors average out; above, products of 30 and more factors that all have the same
// bias.
inline constexpr double kRoundingFactor = 0.2;

}  // namespace koksma
