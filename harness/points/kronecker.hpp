// The irrationals of Kronecker sequences.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace koksma {

// alpha_1 … alpha_dim modulo 1, rounded down to 64 bits; kind "generalised-golden-ratio"
// (phi_dim^-j) or "root-of-prime" (square root of the j-th prime).
std::vector<std::uint64_t> kronecker_fractions(const std::string& kind, std::uint32_t dim);

}  // namespace koksma
