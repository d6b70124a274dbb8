// The integrands of ../problem.py over blocks of points x[point][dimension], in vectors of 32 bytes, so that
// a peer's time is that of its generator. A point's 8 coordinates are a row; the rows of a few points are
// reduced together, by a tree of in-register shuffles, to a vector of one value a point.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace peer {

constexpr std::size_t kDim = 8;
constexpr std::size_t kBlock = 512;  // points; 16 or 32 KiB of coordinates

struct Job {
  std::string integrand;
  std::uint64_t n = 0, seed = 0;
  unsigned replicates = 0;
  double constant = 0;
  std::vector<double> coefficients;  // of dimension 0, then of dimension 1, ...
};

template <typename Real>
struct Wide;

// Rows of 8 floats: pairs, pairs of pairs, halves; value k of the result is that of row k.
template <>
struct Wide<float> {
  using Vector = float __attribute__((vector_size(32)));
  static constexpr std::size_t kWidth = 8, kRow = 1;  // values in a vector, vectors in a row

  template <typename Op>
  static Vector reduce(const Vector (&row)[8][1], Op op) {
    Vector pair[4], four[2];
    for (int k = 0; k < 4; ++k) {
      const Vector a = row[2 * k][0], b = row[2 * k + 1][0];
      pair[k] = op(__builtin_shufflevector(a, b, 0, 8, 1, 9, 4, 12, 5, 13),
                   __builtin_shufflevector(a, b, 2, 10, 3, 11, 6, 14, 7, 15));
    }
    for (int k = 0; k < 2; ++k) {
      const Vector a = pair[2 * k], b = pair[2 * k + 1];
      four[k] = op(__builtin_shufflevector(a, b, 0, 1, 8, 9, 4, 5, 12, 13),
                   __builtin_shufflevector(a, b, 2, 3, 10, 11, 6, 7, 14, 15));
    }
    return op(__builtin_shufflevector(four[0], four[1], 0, 1, 2, 3, 8, 9, 10, 11),
              __builtin_shufflevector(four[0], four[1], 4, 5, 6, 7, 12, 13, 14, 15));
  }
};

// Rows of two vectors of 4 doubles.
template <>
struct Wide<double> {
  using Vector = double __attribute__((vector_size(32)));
  static constexpr std::size_t kWidth = 4, kRow = 2;

  template <typename Op>
  static Vector reduce(const Vector (&row)[4][2], Op op) {
    Vector half[4], pair[2];
    for (int k = 0; k < 4; ++k) half[k] = op(row[k][0], row[k][1]);
    for (int k = 0; k < 2; ++k) {
      const Vector a = half[2 * k], b = half[2 * k + 1];
      pair[k] = op(__builtin_shufflevector(a, b, 0, 4, 2, 6), __builtin_shufflevector(a, b, 1, 5, 3, 7));
    }
    return op(__builtin_shufflevector(pair[0], pair[1], 0, 1, 4, 5),
              __builtin_shufflevector(pair[0], pair[1], 2, 3, 6, 7));
  }
};

// y[i] = the reduction by `op` of term(x_j, j) over the dimensions j of point i.
template <typename Real, typename Term, typename Op>
void reduce_points(const Real* x, std::size_t count, Real* y, Term term, Op op) {
  using W = Wide<Real>;
  using Vector = typename W::Vector;
  std::size_t i = 0;
  for (; i + W::kWidth <= count; i += W::kWidth) {
    Vector row[W::kWidth][W::kRow];
    for (std::size_t k = 0; k < W::kWidth; ++k)
      for (std::size_t h = 0; h < W::kRow; ++h) {
        Vector v;
        std::memcpy(&v, x + (i + k) * kDim + h * W::kWidth, sizeof v);
        row[k][h] = term(v, h);
      }
    const Vector value = W::reduce(row, op);
    std::memcpy(y + i, &value, sizeof value);
  }
  for (; i < count; ++i) {
    Vector row[W::kRow];
    for (std::size_t h = 0; h < W::kRow; ++h) {
      std::memcpy(&row[h], x + i * kDim + h * W::kWidth, sizeof row[h]);
      row[h] = term(row[h], h);
    }
    y[i] = row[0][0];
    for (std::size_t j = 1; j < kDim; ++j) y[i] = op(y[i], row[j / W::kWidth][j % W::kWidth]);
  }
}

// Coefficients first, first + stride, ... of all dimensions as a row of vectors.
template <typename Real>
struct Row {
  using W = Wide<Real>;
  typename W::Vector part[W::kRow];
  Row(const Job& job, std::size_t first, std::size_t stride) {
    for (std::size_t j = 0; j < kDim; ++j)
      part[j / W::kWidth][j % W::kWidth] = static_cast<Real>(job.coefficients[first + j * stride]);
  }
};

template <typename Real>
double total(const Real* y, std::size_t count) {
  double sum = 0;
  for (std::size_t i = 0; i < count; ++i) sum += static_cast<double>(y[i]);
  return sum;
}

// Sums of f over `count` <= kBlock points.
template <typename Real>
double sum_product(const Job& job, const Real* x, std::size_t count) {
  const Row<Real> g(job, 0, 1);
  Real y[kBlock];
  reduce_points(
      x, count, y, [&](auto v, std::size_t h) { return 1 + g.part[h] * (v - Real(0.5)); },
      [](auto a, auto b) { return a * b; });
  return total(y, count);
}

template <typename Real>
double sum_gaussian(const Job& job, const Real* x, std::size_t count) {
  const Row<Real> a(job, 0, 2), u(job, 1, 2);
  Real y[kBlock];
  reduce_points(
      x, count, y,
      [&](auto v, std::size_t h) {
        const auto t = a.part[h] * (v - u.part[h]);
        return t * t;
      },
      [](auto s, auto t) { return s + t; });
  for (std::size_t i = 0; i < count; ++i) y[i] = std::exp(-y[i]);
  return total(y, count);
}

template <typename Real>
double sum_oscillatory(const Job& job, const Real* x, std::size_t count) {
  const Row<Real> a(job, 0, 1);
  const Real constant = static_cast<Real>(job.constant);
  Real y[kBlock];
  reduce_points(
      x, count, y, [&](auto v, std::size_t h) { return a.part[h] * v; },
      [](auto s, auto t) { return s + t; });
  for (std::size_t i = 0; i < count; ++i) y[i] = std::cos(constant + y[i]);
  return total(y, count);
}

}  // namespace peer
