// What the C++ peers share. A peer is a process that reads jobs from standard input, a line each:
//     INTEGRAND DIM N REPLICATES SEED CONSTANT COEFFICIENT...
// and answers each with the seconds it took and the estimate of every replicate. Replicates are dealt to
// two threads, so both cores work whatever the library. The integrands are those of ../problem.py; points
// are generated in blocks that stay in the first-level cache and evaluated there in vectors (integrands.hpp).
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <iostream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "integrands.hpp"

namespace peer {

constexpr unsigned kThreads = 2;

template <typename Real>
using Sum = double (*)(const Job&, const Real*, std::size_t);

template <typename Real>
Sum<Real> sum_of(const Job& job) {
  if (job.integrand == "linear-prod") return sum_product<Real>;
  if (job.integrand == "genz-gaussian") return sum_gaussian<Real>;
  if (job.integrand == "genz-oscillatory") return sum_oscillatory<Real>;
  throw std::runtime_error("unknown integrand " + job.integrand);
}

inline Job parse(const std::string& line) {
  std::istringstream in(line);
  Job job;
  std::size_t dim = 0;
  if (!(in >> job.integrand >> dim >> job.n >> job.replicates >> job.seed >> job.constant) || dim != kDim)
    throw std::runtime_error("bad job: " + line);
  for (double c = 0; in >> c;) job.coefficients.push_back(c);
  return job;
}

// Mean over N points that `fill(x, start, count)` writes block by block.
template <typename Real, typename Fill>
double blockwise_mean(const Job& job, Fill&& fill) {
  alignas(64) Real x[kBlock * kDim];
  const Sum<Real> sum_block = sum_of<Real>(job);
  double sum = 0;
  for (std::uint64_t start = 0; start < job.n; start += kBlock) {
    const std::size_t count = static_cast<std::size_t>(std::min<std::uint64_t>(kBlock, job.n - start));
    fill(x, start, count);
    sum += sum_block(job, x, count);
  }
  return sum / static_cast<double>(job.n);
}

// Answers jobs until standard input ends; estimate(job, replicate) is called from two threads.
template <typename Estimate>
int serve(Estimate&& estimate) {
  std::cout.precision(17);
  for (std::string line; std::getline(std::cin, line);) {
    const Job job = parse(line);
    std::vector<double> estimates(job.replicates);
    const auto work = [&](unsigned thread) {
      for (unsigned r = thread; r < job.replicates; r += kThreads) estimates[r] = estimate(job, r);
    };
    const auto start = std::chrono::steady_clock::now();
    std::thread other(work, 1u);
    work(0);
    other.join();
    std::cout << std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    for (const double e : estimates) std::cout << ' ' << e;
    std::cout << std::endl;
  }
  return 0;
}

}  // namespace peer
