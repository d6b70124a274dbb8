// The error side of `koksma compare`. Method: report/compare.hpp.
#pragma once

#include "report/compare.hpp"

namespace koksma {

// Two rows of one N, with the rounding floor that both cells allow for; `z_limit`: standard normal
// quantile beyond which a difference of intervals is not chance.
ErrorChange error_change(const Json& base, const Json& now, double floor, double z_limit);

// The larger rounding floor of two cells, 0 where neither knows one.
double common_floor(const Json& base_cell, const Json& now_cell);

}  // namespace koksma
