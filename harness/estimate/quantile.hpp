// Quantiles of a sample.
#pragma once

#include <span>

namespace koksma {

// The p-quantile, 0 <= p <= 1, of at least one sorted value: linear between order statistics (type
// 7 of R. J. Hyndman, Y. Fan, Am. Stat. 50 (1996)).
double quantile_of(std::span<const double> sorted, double p);

}  // namespace koksma
