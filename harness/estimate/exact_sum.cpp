#include "estimate/exact_sum.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace koksma {

namespace {

constexpr int kMantissaBits = 53;
// Fewer terms are not worth the two passes.
constexpr std::size_t kExtractFrom = 32;
constexpr std::size_t kWays = 4;  // independent chains of additions, for the pipeline's sake
// All powers of two of an extraction of 2^60 terms at most are normal numbers for sizes between.
constexpr double kSmallestExtracted = 0x1p-800;
constexpr double kLargestExtracted = 0x1p800;

}  // namespace

void ExactSum::add_nonfinite(double term) {
  if (std::isnan(term)) {
    ++nans_;
  } else if (term > 0) {
    ++plus_infinities_;
  } else {
    ++minus_infinities_;
  }
}

void ExactSum::add(std::span<const double> terms) {
  if (terms.size() >= kExtractFrom && add_extracted(terms)) return;
  for (const double term : terms) add(term);
}

// Splits every term p into q + q' + r: q a multiple of the last bit of sigma, q' one of the last
// bit of sigma'. With sigma a power of two above n max|p| every sum of q is exact in double, and so
// is every sum of q' once sigma' lies as far above the largest rest, half a last bit of sigma.
// False, and nothing is added, where a rest r is not zero (terms of very different sizes) or a
// power leaves the range.
bool ExactSum::add_extracted(std::span<const double> terms) {
  const std::size_t whole = terms.size() / kWays * kWays;
  std::array<double, kWays> largest_of{};
  bool finite = true;
  for (std::size_t i = 0; i < whole; i += kWays)
    for (std::size_t way = 0; way < kWays; ++way) {
      const double size = std::fabs(terms[i + way]);
      finite = finite && size <= kLargestExtracted;  // not so a NaN, which a maximum would lose
      largest_of[way] = std::max(largest_of[way], size);
    }
  const double largest = *std::max_element(largest_of.begin(), largest_of.end());
  if (!finite || !(largest >= kSmallestExtracted)) return false;
  const auto log2_terms = static_cast<int>(std::bit_width(whole + 1));
  const double sigma = std::ldexp(1.0, log2_terms + std::ilogb(largest) + 1);
  const double lower = std::ldexp(sigma, log2_terms - kMantissaBits);
  std::array<double, kWays> sum{}, lower_sum{}, rest{};
  for (std::size_t i = 0; i < whole; i += kWays)
    for (std::size_t way = 0; way < kWays; ++way) {
      const double term = terms[i + way];
      const double q = (sigma + term) - sigma;
      const double below = term - q;
      const double lower_q = (lower + below) - lower;
      rest[way] += std::fabs(below - lower_q);
      sum[way] += q;
      lower_sum[way] += lower_q;
    }
  if (std::any_of(rest.begin(), rest.end(), [](double r) { return r != 0; })) return false;
  for (std::size_t way = 0; way < kWays; ++way) {
    add(sum[way]);
    add(lower_sum[way]);
  }
  for (const double term : terms.subspan(whole)) add(term);
  return true;
}

// Brings every digit but the signed top one into [0, 2^32).
void ExactSum::propagate(Digits& digits) {
  std::int64_t carry = 0;
  for (std::size_t k = 0; k + 1 < kDigits; ++k) {
    const std::int64_t digit = digits[k] + carry;
    // The shift rounds towards minus infinity (C++20), so what is left of the digit is never
    // negative.
    carry = digit >> kDigitBits;
    digits[k] = digit & static_cast<std::int64_t>(kDigitMask);
  }
  digits[kDigits - 1] += carry;
}

void ExactSum::propagate() {
  propagate(digits_);
  pending_ = 0;
}

void ExactSum::add(const ExactSum& other) {
  Digits terms = other.digits_;
  propagate(terms);
  propagate();
  for (std::size_t k = 0; k < kDigits; ++k) digits_[k] += terms[k];
  pending_ = 1;
  nans_ += other.nans_;
  plus_infinities_ += other.plus_infinities_;
  minus_infinities_ += other.minus_infinities_;
}

void ExactSum::subtract(const ExactSum& other) {
  Digits terms = other.digits_;
  propagate(terms);
  propagate();
  for (std::size_t k = 0; k < kDigits; ++k) digits_[k] -= terms[k];
  pending_ = 1;
  nans_ += other.nans_;
  plus_infinities_ += other.minus_infinities_;
  minus_infinities_ += other.plus_infinities_;
}

void ExactSum::add_product(double factor, std::uint64_t count) {
  if (!std::isfinite(factor)) {
    // As IEEE arithmetic has it, inf · 0 is NaN.
    add_nonfinite(factor * static_cast<double>(count));
    return;
  }
  // factor = mantissa · 2^(exponent − 53) with an integer mantissa; the product with a 64-bit count
  // has at most 117 bits. The zeros that end the mantissa of a denormal fall into guard bits.
  int exponent = 0;
  const double fraction = std::frexp(std::fabs(factor), &exponent);
  const auto mantissa = static_cast<std::uint64_t>(std::ldexp(fraction, kMantissaBits));
  if (mantissa == 0) return;
  add_shifted(static_cast<Wide>(mantissa) * count, exponent - kMantissaBits, factor < 0);
}

void ExactSum::add_scaled(double term, int exponent) {
  if (!std::isfinite(term)) {
    add_nonfinite(term);
    return;
  }
  int own = 0;
  const double fraction = std::frexp(std::fabs(term), &own);
  auto mantissa = static_cast<std::uint64_t>(std::ldexp(fraction, kMantissaBits));
  if (mantissa == 0) return;
  // A digit's trailing zeros may reach below the guard bits.
  const int zeros = std::countr_zero(mantissa);
  mantissa >>= zeros;
  add_shifted(mantissa, own - kMantissaBits + zeros + exponent, term < 0);
}

void ExactSum::add(std::span<const double> terms, int exponent) {
  if (exponent == 0) return add(terms);
  for (const double term : terms) add_scaled(term, exponent);
}

// Adds magnitude · 2^exponent.
void ExactSum::add_shifted(Wide magnitude, int exponent, bool negative) {
  const auto position = static_cast<std::size_t>(exponent - kLowestExponent);
  // The lowest digit takes what is left of its word, the others 32 bits each.
  std::size_t k = position / kDigitBits;
  std::size_t room = kDigitBits - position % kDigitBits;
  std::size_t shift = position % kDigitBits;
  while (magnitude != 0) {
    const Wide part = magnitude & ((Wide{1} << room) - 1);
    const auto value = static_cast<std::int64_t>(static_cast<std::uint64_t>(part) << shift);
    digits_[k++] += negative ? -value : value;
    magnitude >>= room;
    room = kDigitBits;
    shift = 0;
  }
  if (++pending_ == kMaxPending) propagate();
}

ExactSum::Magnitude ExactSum::magnitude(bool& negative) const {
  Digits digits = digits_;
  propagate(digits);
  negative = digits[kDigits - 1] < 0;
  if (negative) {
    for (std::int64_t& digit : digits) digit = -digit;
    propagate(digits);
  }
  Magnitude result{};
  for (std::size_t k = 0; k < kDigits; ++k) result[k] = static_cast<std::uint32_t>(digits[k]);
  return result;
}

double ExactSum::nonfinite_value() const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (nans_ > 0 || (plus_infinities_ > 0 && minus_infinities_ > 0)) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  return plus_infinities_ > 0 ? kInfinity : -kInfinity;
}

double ExactSum::round_magnitude(const Magnitude& magnitude, bool sticky) {
  std::size_t top = kDigits;
  while (top > 0 && magnitude[top - 1] == 0) --top;
  if (top == 0) return 0;
  const std::size_t length =
      top * kDigitBits - static_cast<std::size_t>(std::countl_zero(magnitude[top - 1]));

  // The last kept bit is the 53rd, or the last one a denormal has.
  const std::size_t last =
      std::max(length, kGuardBits + std::size_t{kMantissaBits}) - std::size_t{kMantissaBits};
  const auto bit = [&](std::size_t i) {
    return (magnitude[i / kDigitBits] >> (i % kDigitBits)) & 1U;
  };
  std::uint64_t kept = 0;
  for (std::size_t i = length; i > last; --i) kept = kept << 1U | bit(i - 1);

  // Round to nearest, ties to even; `last` is at least 64, so there always is a bit below.
  const std::size_t half = last - 1;
  for (std::size_t k = 0; k < half / kDigitBits; ++k) sticky = sticky || magnitude[k] != 0;
  const std::uint32_t below = (std::uint32_t{1} << (half % kDigitBits)) - 1;
  sticky = sticky || (magnitude[half / kDigitBits] & below) != 0;
  if (bit(half) != 0 && (sticky || (kept & 1U) != 0)) ++kept;
  return std::ldexp(static_cast<double>(kept), static_cast<int>(last) + kLowestExponent);
}

double ExactSum::rounded() const {
  if (nonfinite() > 0) return nonfinite_value();
  bool negative = false;
  const double value = round_magnitude(magnitude(negative), false);
  return negative ? -value : value;
}

double ExactSum::rounded_quotient(std::uint64_t count) const {
  if (count == 0) throw std::invalid_argument("ExactSum: a quotient by zero terms");
  if (nonfinite() > 0) return nonfinite_value();
  bool negative = false;
  Magnitude quotient = magnitude(negative);

  // Schoolbook division from the top digit; the remainder only decides the rounding.
  Wide remainder = 0;
  for (std::size_t k = kDigits; k-- > 0;) {
    const Wide dividend = remainder << kDigitBits | quotient[k];
    quotient[k] = static_cast<std::uint32_t>(dividend / count);
    remainder = dividend % count;
  }
  const double value = round_magnitude(quotient, remainder != 0);
  return negative ? -value : value;
}

}  // namespace koksma
