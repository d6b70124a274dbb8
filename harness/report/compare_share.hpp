// How much of the calibration's change times follow. Calibrating is exact only where a row slows
// down as much as the calibration kernel does: beside somebody else's thread on the same core,
// kernels bound by throughput take up to 1.8 times as long, those that wait for their own results
// 1.1 times (results/README.md). Of the calibration's change, in logarithms, rows follow a share: 1
// where times are multiples of it, 0 where it does not touch them. What is compared is what they do
// not follow.
#pragma once

#include <optional>
#include <vector>

#include "report/compare.hpp"
#include "report/compare_times.hpp"

namespace koksma {

// The share within runs, which a change between them does not enter: the slope of the times of a
// row over their calibrations, by Theil (1950) and Sen (1968), the median over all pairs of
// launches of a row in one run whose calibrations differ by more than kSpeedsDiffer, and by more
// than four standard deviations of neighbours, as noise alone has no slope. Unknown where less than
// kLeastPairs of all pairs are such, as the device was as fast throughout, or where fewer than
// kLeastCalibrations are the slower or the faster ones of them: those are disturbances.
inline constexpr double kSpeedsDiffer = 1.15, kLeastPairs = 0.05;
inline constexpr std::size_t kLeastCalibrations = 8;
std::optional<double> share_within(const std::vector<Launches>& rows);

// The share between runs, where it is unknown within: the same slope of the rows' changes over
// those of their calibrations, over pairs of rows whose calibrations changed differently, by more
// than kSpeedsApart. What is slower in all rows cancels, what is slower in a quarter of them hardly
// moves it. 1 where it is within kFollowsFully of it, as it is not known well. Unknown where less
// than a tenth of all pairs are such, as where one run knew one speed throughout and the other
// another.
struct RowShift {
  double time, calibration;  // how much larger the new logarithms are
};
RowShift shift_of(const Launches& base, const Launches& now);
inline constexpr double kSpeedsApart = 1.28, kFollowsFully = 0.15;
std::optional<double> share_between(const std::vector<RowShift>& rows);

// What is taken out of the changes of times between two runs, a share of the calibration's change
// beside them, and what may still be in them.
struct Followed {
  double share = 1;
  // How much slower the device itself became, as a logarithm: its change is nobody's on the same
  // core, so times may follow another part of it.
  double clock = 0;
  double least = 1;  // share that a study follows

  // Logarithms of changes that this explains: of a study, whose times follow the least share or up
  // to all, and of one row or cell, which may follow none of it.
  Interval explained() const { return between(least); }
  Interval explained_of_one() const { return between(0); }

 private:
  Interval between(double low) const;
};

// The share within, and the clock by the calibration's fastest launches. Where it is unknown, as
// each run knew one speed, the whole change may be the clock's; the share is 1 then, if the
// calibration changed by less than kSpeedsDiffer, though a study may follow none of so little, else
// that between runs, or 0. base[i] and now[i]: of the same row.
Followed what_is_followed(const std::vector<Launches>& base, const std::vector<Launches>& now);

}  // namespace koksma
