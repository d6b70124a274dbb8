// How heavy the tail of f is: the excess kurtosis of one value, as far as it may be believed.
//
// The mean of N independent values has the excess kurtosis of one over N, and where that is small
// its normal approximation is believed (page 5, section 3). An estimate alone does not do: that of
// n values is below n however heavy the tail is, since one value can hold all of the fourth moment.
// Entries may say what it is; an estimate near its ceiling is taken as none.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "device/exact.hpp"

namespace koksma {

struct Kurtosis {
  std::optional<double> excess;  // of one value of f; none: not estimated, or not believed
  std::string unbounded;         // why it may be anything, else empty
};

// Fewer values say nothing about a tail.
inline constexpr std::size_t kFewestForKurtosis = 256;

// From values of f. Not believed where fewer than about 20 values make up the variance (excess
// above n/20; 0 and 1 with a frequency of k/n have n/k), one value holds more than half of the
// fourth moment, all values are alike, or they show less than half of `variance`, the exact one.
// Fewer than 256 values or a non-finite one: nothing is known, and nothing held against f.
Kurtosis estimate_kurtosis(std::span<const double> values, std::optional<double> variance);

// What the entry states: of an f of values 0 and 1 it is 1/V − 6, V = I (1 − I) the exact variance.
// None where the entry says nothing, or V is not known.
std::optional<Kurtosis> stated_kurtosis(const Integrand& integrand, const ExactValues& exact);

}  // namespace koksma
