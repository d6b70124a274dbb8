// The Pareto front of error against time: what nothing else beats in both.
//
// A point dominates another where it is no worse in time and in error, and better in one of them
// (K. Miettinen, Nonlinear Multiobjective Optimization, Kluwer 1999, definition 2.2.1).
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace koksma {

struct ErrorTime {
  double seconds = 0;
  double error = 0;  // >= 0
};

// Indices of the points that no other point dominates, by ascending time; equal points are all on
// the front, in their order. Points with a time that is not positive and finite, or an error that
// is not finite or below 0, are on no front and dominate nothing.
std::vector<std::size_t> pareto_front(std::span<const ErrorTime> points);

}  // namespace koksma
