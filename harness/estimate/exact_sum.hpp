// Exact, order-free accumulation of doubles.
//
// A long accumulator holds every bit a double can have, so a sum is rounded once, at the end: any
// grouping of the terms by launch, device, process or resume gives the same bits. Method: U.
// Kulisch, Computer Arithmetic and Validity (2013), ch. 8; the carry-save digits are those of R. M.
// Neal, Fast exact summation using small and large superaccumulators, arXiv:1505.05571 (2015),
// section 3. Many terms at once are first split at two fixed powers of two by error-free
// extraction: S. M. Rump, T. Ogita, S. Oishi, Accurate floating-point summation part I, SIAM J.
// Sci. Comput. 31 (2008), algorithm 3.3 and theorem 3.4.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

namespace koksma {

class ExactSum {
 public:
  // Adds one term exactly. Non-finite terms are counted, see rounded(). 5 to 10 ns.
  void add(double term) {
    const auto bits = std::bit_cast<std::uint64_t>(term);
    const auto exponent = static_cast<unsigned>(bits >> 52U) & kExponentMask;
    if (exponent == kExponentMask) {
      add_nonfinite(term);
      return;
    }
    // Denormals share the position of the smallest normal exponent and lack the hidden bit.
    const std::uint64_t normal = exponent != 0 ? 1 : 0;
    const std::uint64_t mantissa = (bits & kMantissaMask) | (normal << 52U);
    const std::size_t position = kGuardBits + exponent - static_cast<unsigned>(normal);
    const auto sign = -static_cast<std::int64_t>(bits >> 63U);
    const std::size_t shift = position % kDigitBits;
    const std::uint64_t low = mantissa << shift;
    // Two shifts, because a shift by 64 would be undefined.
    const std::uint64_t high = (mantissa >> 1U) >> (63U - shift);
    std::int64_t* const digit = &digits_[position / kDigitBits];
    digit[0] += (static_cast<std::int64_t>(low & kDigitMask) ^ sign) - sign;
    digit[1] += (static_cast<std::int64_t>(low >> kDigitBits) ^ sign) - sign;
    digit[2] += (static_cast<std::int64_t>(high) ^ sign) - sign;
    if (++pending_ == kMaxPending) propagate();
  }

  // All of them exactly; of more than a few of similar size 1 to 2 ns each.
  void add(std::span<const double> terms);

  // Adds term · 2^exponent exactly, also where that is not a double: a last bit of at least 2^-1138
  // and a magnitude below 2^1220. Digits of long accumulators are such terms.
  void add_scaled(double term, int exponent);
  void add(std::span<const double> terms, int exponent);

  // Adds another sum exactly; non-finite counts add up.
  void add(const ExactSum& other);

  // Adds factor · count exactly, also where the product is not a double.
  void add_product(double factor, std::uint64_t count);

  void subtract(double term) { add(-term); }

  // Subtracts another sum exactly. As in IEEE arithmetic, inf − inf is NaN.
  void subtract(const ExactSum& other);

  // The sum, correctly rounded to nearest even, ±inf where it exceeds the range of double. With
  // non-finite terms the IEEE result: NaN if there was a NaN or infinities of both signs, else the
  // infinity. An exact zero is +0.
  double rounded() const;

  // sum / count, correctly rounded once (no overflow where the quotient is in range). Throws
  // std::invalid_argument for count = 0.
  double rounded_quotient(std::uint64_t count) const;

  // How many terms were NaN or infinite.
  std::uint64_t nonfinite() const { return nans_ + plus_infinities_ + minus_infinities_; }

 private:
  // Digit k weighs 2^(32k − 1074 − 64). Doubles fill bits 64 to 2162; the 64 guard bits below
  // belong to quotients, the bits above hold carries of 2^63 terms and products with 64-bit counts.
  static constexpr std::size_t kDigitBits = 32;
  static constexpr std::size_t kGuardBits = 64;
  static constexpr std::size_t kDigits = 74;
  static constexpr int kLowestExponent = -1074 - static_cast<int>(kGuardBits);
  static constexpr std::uint64_t kDigitMask = 0xffffffffU;
  static constexpr unsigned kExponentMask = 0x7ffU;
  static constexpr std::uint64_t kMantissaMask = (std::uint64_t{1} << 52U) - 1;
  // A digit grows by less than 2^32 a term, so 2^30 terms stay below 2^62 + 2^32.
  static constexpr std::uint32_t kMaxPending = std::uint32_t{1} << 30U;

  using Digits = std::array<std::int64_t, kDigits>;
  using Magnitude = std::array<std::uint32_t, kDigits>;

  void add_nonfinite(double term);
  bool add_extracted(std::span<const double> terms);
  __extension__ using Wide = unsigned __int128;
  void add_shifted(Wide magnitude, int exponent, bool negative);
  void propagate();
  static void propagate(Digits& digits);
  Magnitude magnitude(bool& negative) const;
  double nonfinite_value() const;
  static double round_magnitude(const Magnitude& magnitude, bool sticky);

  Digits digits_{};
  std::uint32_t pending_ = 0;
  std::uint64_t nans_ = 0;
  std::uint64_t plus_infinities_ = 0;
  std::uint64_t minus_infinities_ = 0;
};

}  // namespace koksma
