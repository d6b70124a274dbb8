// L2 discrepancies and diaphony by their double sums over pairs of points, in SciPy's convention
// (scipy.stats.qmc.discrepancy): the formulas and their sources are at the head of the kernels in
// kernels/quality/pairs.cl.
#pragma once

#include "quality/kernels.hpp"

namespace koksma {

// All squared. Rounding can make a tiny one negative.
struct L2Discrepancies {
  double l2star2 = 0, cd2 = 0, wd2 = 0, md2 = 0, diaphony2 = 0;
};

// O(N^2 d) on the device; the sums of the rows are merged exactly.
L2Discrepancies l2_discrepancies(QualityKernels& kernels, const PointSet& points);

// The least Euclidean distance of two points on the torus; 0 for a point that occurs twice. N >= 2.
double minimum_toroidal_distance(QualityKernels& kernels, const PointSet& points);

}  // namespace koksma
