// The cases of `koksma stability`: what the entries of the integrands list, with the verdict that
// each must get, or the usual cells of a scene that the user names.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "estimate/interval.hpp"
#include "study/study.hpp"

namespace koksma {

// What a case must show.
struct Demand {
  std::string verdict;
  bool overflow = false;           // the mark OVERFLOW: there, or not
  std::string held_by;             // the floor that the error is known to be; may be empty
  std::optional<Interval> bias;    // of the integrator's relative bias, E f_h / I − 1
  std::optional<Interval> digits;  // of −log10 of the relative RMSE, at the largest N
  std::string note;                // why
};

struct Suite {
  Study study;                                 // one cell per case
  std::vector<std::optional<Demand>> demands;  // by case; none: it is only reported
};

// Every case of every entry, in the order of the catalog. InputError names the entry whose case is
// wrong.
Suite full_suite(const Catalog& catalog);

// Of each scene the cases of its entry (all of them where only NAME is given, else those of that
// very scene), and three cells of no demand: scrambled points in fp64 and fp32, and the exact
// points that contain 0.
Suite suite_of(const Catalog& catalog, const std::vector<std::string>& scenes);

}  // namespace koksma
