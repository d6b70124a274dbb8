// How far rounding while summing moves a mean: worst case and estimate, from the sum's entry.
//
// Floors come in two kinds (page 5, section 2.1): the worst-case bound, which naive fp32 sums stay
// a factor of 10^3 below, and the estimate, on which floors, exclusions and verdicts rest. Sources:
// N. J. Higham, SIAM J. Sci. Comput. 14 (1993); N. J. Higham and T. Mary, SIAM J. Sci. Comput. 41
// (2019) A2815 (probabilistic, sqrt(n)); the entries of kernels/sums/ name those of their own.
#pragma once

#include "catalog/catalog.hpp"
#include "study/study.hpp"

namespace koksma {

// An error of the mean of f: relative to E|f|, plus what does not scale with f (the quantum of a
// fixed-point sum).
struct SummationError {
  double relative = 0;
  double absolute = 0;  // in the unit of f

  double of(double mean_abs) const { return relative * mean_abs + absolute; }
};

// `n_per_lane`: terms that one accumulator adds one after the other, at least 1: a block of 2^b
// samples has 16 accumulators, which are merged exactly. The unit roundoff is that of the words in
// which the sum accumulates: 2^-53 for `double`, whatever the precision of the samples.
// The bound holds for every order and all data (to first order in n u where the entry's source says
// so). It is at most 1 where the sum stagnates.
SummationError summation_bound(const SumAlgorithm& sum, Precision precision, double n_per_lane);
// Of one accumulator, and of data whose roundings are independent; those of a constant are not and
// may reach the bound. The mean over L accumulators of independent data has 1/sqrt(L) of it.
SummationError summation_estimate(const SumAlgorithm& sum, Precision precision, double n_per_lane);

}  // namespace koksma
