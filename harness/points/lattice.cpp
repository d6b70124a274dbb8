// Tables of the lattice family (kernels/points/lattice.cl): generating vectors and shifts in fixed
// point.
#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "catalog/embedded.hpp"
#include "catalog/lanes.hpp"
#include "error/error.hpp"
#include "points/tables.hpp"

namespace koksma {
namespace {

constexpr std::uint32_t kLatticeHeader = 8;

std::vector<std::uint64_t> read_vector(const std::string& name, std::uint32_t dim) {
  const std::string path = fmt::format("kernels/points/vectors/{}.json", name);
  const Json entry = parse_json(embedded_text(path), path);
  const auto z = entry["z"].get<std::vector<std::uint64_t>>();
  if (z.size() < dim)
    throw InputError(path, fmt::format("{} components", z.size()),
                     fmt::format("{} are drawn", dim));
  return {z.begin(), z.begin() + dim};
}

// phi_2(gray) z mod 1 as a 64-bit fraction: bit k of gray weighs 2^-(k+1).
std::uint64_t contribution(std::uint64_t z, std::uint32_t k) { return z << (63 - k); }

// How a 64-bit fraction is kept on the device.
struct LatticeForm {
  bool fp64 = true;
  bool whole = false;  // all bits of the word, else the top 52 at its low end in fp64

  std::uint64_t operator()(std::uint64_t fraction) const {
    if (!fp64) return fraction >> 32;
    return whole ? fraction : fraction >> 12;
  }
  std::uint64_t start(std::uint64_t shift) const {
    if (fp64 || whole) return (*this)(shift);
    // 23 bits in the top of a signed word, offset so that the signed conversion is centred on 1/2.
    return ((shift >> 32) & ~std::uint64_t{511}) ^ 0x80000000u;
  }
};

// What all lanes share moves by this when bit 4 + c of gray comes or goes.
std::uint64_t step_of(std::uint64_t z, std::uint32_t c, bool comes) {
  const std::uint64_t size = contribution(z, 4 + c);
  return comes ? size : -size;
}

std::uint64_t lane_point(std::uint64_t z, std::uint32_t lane, bool odd) {
  const std::uint32_t gray = (lane ^ lane >> 1) ^ (odd ? 8u : 0u);
  std::uint64_t point = 0;
  for (std::uint32_t k = 0; k < 4; ++k)
    if ((gray >> k & 1) != 0) point += contribution(z, k);
  return point;
}

// Odd residues modulo 2^64, of which the lattice of 2^k points uses those modulo 2^k: uniform among
// the odd ones.
std::vector<std::uint64_t> random_vector(const PointRequest& request, std::uint32_t replicate) {
  std::vector<std::uint64_t> z;
  for (std::uint32_t d = 0; d < request.dim; ++d)
    z.push_back(random_pair(request.seed, 0, replicate, RandomPurpose::lattice_vector, d).first |
                1);
  return z;
}

// Where the parts of the first vector begin.
struct Sections {
  std::uint64_t steps = 0, lanes = 0;
};

// Appends steps [c - 4][comes][D] (in few dimensions [16] lanes of each, and columns [c - 4][D]
// before them; in many the steps that come are the columns) and lanes [j_0][D][16] of one
// generating vector.
Sections append_vector(std::vector<std::uint64_t>& words, const std::vector<std::uint64_t>& z,
                       std::uint32_t columns, const LatticeForm& form) {
  Sections sections;
  const bool wide = z.size() <= kMostUnrolledDim;
  const auto push = [&](std::uint64_t fraction) { words.push_back(form(fraction)); };
  for (std::uint32_t k = 4; wide && k < columns; ++k)
    for (const std::uint64_t component : z) push(contribution(component, k));
  sections.steps = words.size();
  for (std::uint32_t c = 0; c + 4 < columns; ++c)
    for (const bool comes : {false, true})
      for (const std::uint64_t component : z) {
        const std::uint64_t shared = step_of(component, c, comes);
        if (!wide) push(shared);
        // The new j is odd exactly when c = 0.
        for (std::uint32_t lane = 0; wide && lane < kLanes; ++lane)
          push(shared + lane_point(component, lane, c == 0) - lane_point(component, lane, c != 0));
      }
  sections.lanes = words.size();
  for (const bool odd : {false, true})
    for (const std::uint64_t component : z)
      for (std::uint32_t lane = 0; lane < kLanes; ++lane) push(lane_point(component, lane, odd));
  return sections;
}

}  // namespace

PointTable build_lattice(const PointRequest& request) {
  const std::string randomize = request.options.at("randomize");
  const std::string source = request.options.at("vector");
  const bool random_vectors = source == "drawn";
  const LatticeForm form{request.fp64, request.options.value("tent", false)};
  const std::uint32_t columns =
      std::max(static_cast<std::uint32_t>(std::bit_width(request.end_index - 1)), 4u);

  PointTable table;
  std::vector<std::uint64_t>& words = table.words;
  words.resize(kLatticeHeader);
  const std::uint32_t vectors = random_vectors ? request.replicates : 1;
  Sections sections;
  for (std::uint32_t r = 0; r < vectors; ++r) {
    const std::vector<std::uint64_t> z =
        random_vectors ? random_vector(request, r)
                       : in_draw_order(request, read_vector(source, request.dim));
    const Sections each = append_vector(words, z, columns, form);
    if (r == 0) sections = each;
  }
  const std::uint64_t vector_size = (words.size() - kLatticeHeader) / vectors;
  const std::uint64_t starts = words.size();
  for (std::uint32_t r = 0; r < request.replicates; ++r) {
    for (std::uint32_t d = 0; d < request.dim; ++d) {
      const std::uint64_t shift =
          randomize == "shift"
              ? random_pair(request.seed, 0, r, RandomPurpose::lattice_shift, d).first
              : 0;
      words.push_back(form.start(shift));
    }
  }
  const std::uint64_t header[kLatticeHeader] = {request.dim,
                                                kLatticeHeader,
                                                sections.steps,
                                                sections.lanes,
                                                starts,
                                                random_vectors ? vector_size : 0,
                                                0,
                                                0};
  std::copy(std::begin(header), std::end(header), words.begin());
  return table;
}

}  // namespace koksma
