// Does a convergence curve end flat, and where does it bend?
//
// Two questions, asked apart (page 5, sections 0 and 2.9). Whether the last rows are flat is
// decided on all rows, before any is excluded for its floor, and must be more than chance: the
// slope of the end must exclude the slowest rate that a converging sampler has. Where a curve bends
// is a broken-stick fit (two joined lines; V. M. R. Muggeo, Estimating regression models with
// unknown break-points, Stat. Med. 22 (2003)), accepted by ΔAICc > 6 (K. P. Burnham, D. R.
// Anderson, Model Selection and Multimodel Inference, 2002, section 2.6).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace koksma {

struct ConvergenceRow;

// numeric: at the level of rounding, grid or model. structural: the points themselves converge no
// further (aliasing, a short dual vector, an unconverged sequence).
enum class PlateauKind { none, numeric, structural };
std::string_view plateau_name(PlateauKind kind);  // "none", "numeric", "structural"

struct Plateau {
  PlateauKind kind = PlateauKind::none;
  std::uint64_t from = 0;       // N of its first row; this and all below only where there is one
  std::size_t rows = 0;         // to the end of the curve
  double slope = 0;             // of log2 RMSE
  double level = 0;             // geometric mean of the RMSE
  std::optional<double> floor;  // geometric mean of the estimated floors, where there are any
  std::string reason;           // what made it one, or why it could not be decided
};

// Two lines that meet at N = 2^log2_samples.
struct Break {
  double log2_samples = 0;
  double slope_before = 0, slope_after = 0;  // of log2 RMSE
  double delta_aicc = 0;                     // AICc of one line less that of two, above 6
};

// Slopes of log2 RMSE this near 0 are flat (page 5, section 0).
inline constexpr double kFlatSlope = 0.1;

// The slowest rate of a sampler that converges on an integrand of finite variance: that of
// independent samples.
inline constexpr double kSlowestRate = -0.5;

// Nominal false-alarm probability of a curve, shared among its possible ends (Bonferroni). The
// distribution of log2 RMSE is not quite normal: what power laws really show is in
// estimate_plateau_test.
inline constexpr double kPlateauLevel = 2e-4;

// The longest end of at least 4 rows and 3 octaves that is flat: |slope| < 0.1, and significantly
// above kSlowestRate. Nothing has to be significant where each row is at the floor (RMSE < 3 F):
// there the longest end with slope > -0.1 counts. A numeric end may also rise, as naive sums do. A
// curve whose last RMSE is 0 ends exact, and not flat. Rows by ascending N, equal in their number
// of replicates, finite.
Plateau find_plateau(const std::vector<const ConvergenceRow*>& rows);

// The break of log2 RMSE, by least squares without weights. None for fewer than 7 rows, where AICc
// does not exist, an RMSE of 0, or a break that is not accepted.
std::optional<Break> find_break(const std::vector<const ConvergenceRow*>& rows);

}  // namespace koksma
