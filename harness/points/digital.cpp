// Tables of the digital family (kernels/points/digital.cl): generating matrices, their scrambles,
// shifts and keys.
#include <algorithm>
#include <bit>

#include "catalog/lanes.hpp"
#include "points/matrices.hpp"
#include "points/tables.hpp"
#include "points/words.hpp"

namespace koksma {
namespace {

constexpr std::uint32_t kDigitalHeader = 8;

// How a 64-bit fraction is kept on the device: mantissa bits in place, reversed for hashing, or on
// top of a signed word.
struct WordForm {
  bool fp64 = true;
  bool reversed = false;
  bool on_top = false;

  std::uint64_t operator()(std::uint64_t fraction) const {
    if (reversed) return fp64 ? reverse_bits(fraction) : reverse_bits(fraction) & 0xFFFFFFFFu;
    if (on_top) return fraction >> 41 << 9;
    return fp64 ? fraction >> 12 : fraction >> 41;
  }
  // The pattern of 1.0, which makes a mantissa a float in [1,2); hashed words get it on the device,
  // signed ones their centre.
  std::uint64_t one() const {
    return reversed || on_top ? 0 : fp64 ? 0x3FF0000000000000u : 0x3F800000u;
  }
};

// Random linear scramble (Matousek 1998): every column becomes L c, L lower triangular with unit
// diagonal, one L per replicate and dimension, on all 64 digits.
GeneratingMatrices scrambled(const GeneratingMatrices& plain, std::uint64_t seed,
                             std::uint32_t replicate) {
  GeneratingMatrices result = plain;
  for (std::uint32_t d = 0; d < plain.dim; ++d) {
    std::uint64_t columns_of_l[64];
    for (std::uint32_t k = 0; k < 64; k += 2) {
      const RandomPair random =
          random_pair(seed, k / 2, replicate, RandomPurpose::linear_scramble, d);
      const std::uint64_t words[2] = {random.first, random.second};
      for (std::uint32_t i = 0; i < 2; ++i) {
        const std::uint64_t diagonal = std::uint64_t{1} << (63 - k - i);
        columns_of_l[k + i] = diagonal | (words[i] & (diagonal - 1));
      }
    }
    for (std::uint32_t k = 0; k < plain.columns; ++k) {
      std::uint64_t& word = result.words[std::size_t{k} * plain.dim + d];
      std::uint64_t product = 0;
      for (std::uint64_t rest = word; rest != 0; rest &= rest - 1)
        product ^= columns_of_l[std::countl_zero(rest & -rest)];
      word = product;
    }
  }
  return result;
}

// Appends steps [c - 4][D] and lanes [D][16] of one matrix set: column c ^ column 3 and the points
// of the first 16 indices. Seeking takes the same steps: the index of a block's first sample has an
// even number of Gray digits above the third, so column 3 cancels.
void append_matrices(std::vector<std::uint64_t>& words, const GeneratingMatrices& m,
                     const WordForm& form) {
  const auto column = [&](std::uint32_t k, std::uint32_t d) {
    return m.words[std::size_t{k} * m.dim + d];
  };
  for (std::uint32_t k = 4; k < m.columns; ++k)
    for (std::uint32_t d = 0; d < m.dim; ++d) words.push_back(form(column(k, d) ^ column(3, d)));
  for (std::uint32_t d = 0; d < m.dim; ++d) {
    for (std::uint32_t lane = 0; lane < kLanes; ++lane) {
      std::uint64_t point = 0;
      const std::uint32_t gray = lane ^ lane >> 1;
      for (std::uint32_t k = 0; k < 4; ++k)
        if ((gray >> k & 1) != 0) point ^= column(k, d);
      words.push_back(form(point));
    }
  }
}

void append_starts(std::vector<std::uint64_t>& words, const PointRequest& request,
                   const WordForm& form, bool shifted) {
  for (std::uint32_t r = 0; r < request.replicates; ++r) {
    for (std::uint32_t d = 0; d < request.dim; ++d) {
      const std::uint64_t shift =
          shifted ? random_pair(request.seed, 0, r, RandomPurpose::digital_shift, d).first : 0;
      words.push_back(form(shift) ^ form.one());
    }
  }
}

// Nested scrambling: an addend and an odd factor per replicate and dimension.
void append_keys(std::vector<std::uint64_t>& words, const PointRequest& request) {
  const std::uint64_t kept = request.fp64 ? ~std::uint64_t{0} : 0xFFFFFFFFu;
  for (std::uint32_t r = 0; r < request.replicates; ++r) {
    for (std::uint32_t d = 0; d < request.dim; ++d) {
      const RandomPair key = random_pair(request.seed, 0, r, RandomPurpose::nested_scramble, d);
      words.push_back(key.first & kept);
      words.push_back((key.second | 1) & kept);
    }
  }
}

}  // namespace

PointTable build_digital(const PointRequest& request) {
  const std::string randomize = request.options.at("randomize");
  const bool linear = randomize == "lms-shift", nested = randomize == "owen";
  // An interlaced coordinate has several components, each of them a dimension of the net.
  PointRequest net = request;
  net.dim *= request.options.value("interlace", 1U);
  const auto needed = static_cast<std::uint32_t>(std::bit_width(request.end_index - 1));
  const std::uint32_t columns = std::clamp(needed, 4u, kMaxMatrixColumns);
  const GeneratingMatrices plain = generating_matrices(net, columns);
  // KOKSMA_DIGITAL_SIGNED of kernels/points/digital.cl.
  const bool on_top = request.centred_draws && !request.fp64 && request.dim <= kMostUnrolledDim &&
                      !nested && net.dim == request.dim;
  const WordForm form{request.fp64, nested, on_top};

  PointTable table;
  std::vector<std::uint64_t>& words = table.words;
  words.resize(kDigitalHeader);
  const std::uint32_t matrix_sets = linear ? request.replicates : 1;
  for (std::uint32_t r = 0; r < matrix_sets; ++r)
    append_matrices(words, linear ? scrambled(plain, request.seed, r) : plain, form);
  const std::uint64_t matrix_size = (words.size() - kDigitalHeader) / matrix_sets;
  const std::uint64_t starts = words.size();
  append_starts(words, net, form, randomize == "shift" || linear);
  const std::uint64_t keys = words.size();
  if (nested) append_keys(words, net);

  const std::uint64_t d = net.dim;
  const std::uint64_t header[kDigitalHeader] = {
      linear ? matrix_size : 0,           d,      0,    kDigitalHeader,
      kDigitalHeader + (columns - 4) * d, starts, keys, 0};
  std::copy(std::begin(header), std::end(header), words.begin());
  return table;
}

}  // namespace koksma
