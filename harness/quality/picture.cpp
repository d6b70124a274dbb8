#include "quality/picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

namespace koksma {
namespace {

constexpr int kMargin = 36, kPanel = 540, kMatrix = 840, kTitle = 64;
constexpr std::uint32_t kMostProjected = 8;
const Colour kInk = grey(0.1), kFrame = grey(0.65), kGuide = grey(0.8), kText = grey(0.25);
const Colour kCurve{0.01F, 0.12F, 0.45F}, kNoise{0.8F, 0.25F, 0.1F};  // white noise: a red line

struct Box {
  double left, top, width, height;

  double x(double t) const { return left + t * width; }
  double y(double t) const { return top + (1 - t) * height; }  // upwards, as in a plot
};

void draw_frame(Canvas& canvas, const Box& box) {
  canvas.frame(box.left, box.top, box.left + box.width, box.top + box.height, kFrame);
}

void draw_caption(Canvas& canvas, const Box& box, const std::string& words) {
  canvas.text(box.left, box.top - 20, 1, words, kText);
}

// Dots whose area keeps to a fixed share of the square, within what the eye can tell apart.
void draw_points(Canvas& canvas, const Box& box, const PointSet& points, std::uint32_t first,
                 std::uint32_t second) {
  const auto n = static_cast<double>(points.size());
  const double radius = std::clamp(0.16 * box.width / std::sqrt(n), 0.35, 3.0);
  for (std::uint64_t i = 0; i < points.size(); ++i) {
    const double height =
        points.dim == 1 ? (static_cast<double>(i) + 0.5) / n : points.at(i, second);
    canvas.dot(box.x(points.at(i, first)), box.y(height), radius, kInk);
  }
  draw_frame(canvas, box);
}

// P / (1 + P): 0 is black, white noise (1) middle grey, peaks white. The zero frequency is left
// out.
void draw_spectrum(Canvas& canvas, const Box& box, const PowerSpectrum& s) {
  const std::size_t width = 2 * std::size_t{s.reach} + 1;
  std::vector<Colour> colours(width * width);
  for (std::size_t kx = 0; kx < width; ++kx)
    for (std::size_t ky = 0; ky < width; ++ky) {
      const bool zero = kx == s.reach && ky == s.reach;
      const double p = zero ? 0 : s.power[kx * width + ky];
      colours[(width - 1 - ky) * width + kx] = grey(p / (1 + p));
    }
  canvas.image(box.left, box.top, box.width, width, colours);
  draw_frame(canvas, box);
}

struct Curve {
  std::string caption, x_label;
  std::vector<double> x;
  std::vector<std::optional<double>> y;  // gaps where there is nothing
  double x_most, low, high, step;        // of the axes, and between guide lines
  double white_noise;                    // a line of its own
};

void draw_axes(Canvas& canvas, const Box& box, const Curve& curve) {
  const auto right_aligned = [&](double level) {
    const std::string words = fmt::format("{:.3g}", level);
    canvas.text(box.left - 8 - Canvas::text_width(1, words),
                box.y((level - curve.low) / (curve.high - curve.low)) - 4, 1, words, kText);
  };
  const auto guide = [&](double level, const Colour& colour) {
    const double y = box.y((level - curve.low) / (curve.high - curve.low));
    canvas.line(box.left, y, box.left + box.width, y, 1, colour);
  };
  for (double level = curve.low + curve.step; level < curve.high - curve.step / 2;
       level += curve.step)
    guide(level, kGuide);
  guide(curve.white_noise, kNoise);
  right_aligned(curve.low);
  right_aligned(curve.high);
  for (const double t : {0.0, 0.5, 1.0}) {
    const std::string words = fmt::format("{:.3g}", t * curve.x_most);
    canvas.text(box.x(t) - Canvas::text_width(1, words) / 2, box.top + box.height + 6, 1, words,
                kText);
  }
  canvas.text(box.x(0.75), box.top + box.height + 6, 1, curve.x_label, kText);
  draw_caption(canvas, box, curve.caption);
}

void draw_curve(Canvas& canvas, const Box& box, const Curve& curve) {
  draw_axes(canvas, box, curve);
  const auto height = [&](double y) {
    return box.y(std::clamp((y - curve.low) / (curve.high - curve.low), 0.0, 1.0));
  };
  for (std::size_t i = 0; i + 1 < curve.x.size(); ++i)
    if (curve.y[i] && curve.y[i + 1])
      canvas.line(box.x(curve.x[i] / curve.x_most), height(*curve.y[i]),
                  box.x(curve.x[i + 1] / curve.x_most), height(*curve.y[i + 1]), 1.6, kCurve);
  draw_frame(canvas, box);
}

// From 0 to a multiple of 1/2 above the values, but not beyond 4: peaks of a lattice are cut.
Curve positive_curve(const std::string& caption, const std::string& x_label,
                     const std::vector<double>& x, const std::vector<double>& y, double x_most) {
  const double most = *std::max_element(y.begin(), y.end());
  const double high = std::clamp(std::ceil(2.2 * most) / 2, 1.5, 4.0);
  const std::string cut = most > high ? fmt::format(", cut at {} of {:.3g}", high, most) : "";
  return {caption + cut, x_label, x, {y.begin(), y.end()}, x_most, 0, high, 0.5, 1};
}

std::vector<Curve> planar_curves(const Quality& quality) {
  std::vector<Curve> curves;
  if (quality.power_spectrum) {
    const PowerSpectrum& s = *quality.power_spectrum;
    std::vector<double> rings(s.radial_mean.size());
    std::iota(rings.begin(), rings.end(), 1);
    curves.push_back(positive_curve("radial mean power; red: white noise", "|k|", rings,
                                    s.radial_mean, s.reach));
    curves.push_back({"anisotropy in dB; red: white noise", "|k|", rings, s.anisotropy_db,
                      static_cast<double>(s.reach), -30, 30, 10,
                      -10 * std::log10(s.distinct_sets)});
  }
  if (quality.pair_correlation) {
    const PairCorrelation& g = *quality.pair_correlation;
    curves.push_back(positive_curve("pair correlation; red: white noise", "r", g.radius, g.value,
                                    g.radius.back() + g.bin_width / 2));
  }
  return curves;
}

// The second and third columns of a planar set.
void draw_planar(Canvas& canvas, const Quality& quality) {
  const Box image{2.0 * kMargin + kPanel, kTitle, kPanel, kPanel};
  if (quality.power_spectrum) {
    const PowerSpectrum& s = *quality.power_spectrum;
    draw_spectrum(canvas, image, s);
    draw_caption(canvas, image,
                 fmt::format("power spectrum P / (1 + P), |k| <= {}, mean of {} distinct set{}",
                             s.reach, s.distinct_sets, s.distinct_sets == 1 ? "" : "s"));
  } else {
    draw_frame(canvas, image);
    draw_caption(canvas, image, "power spectrum: not computed");
  }
  const double gap = 54, height = (kPanel - 2 * gap) / 3;
  Box box{3.0 * kMargin + 2 * kPanel, kTitle, kPanel, height};
  for (const Curve& curve : planar_curves(quality)) {
    draw_curve(canvas, box, curve);
    box.top += height + gap;
  }
}

// Coordinate j + 1 of the rows against coordinate i of the columns, i <= j.
void draw_projections(Canvas& canvas, const PointSet& points) {
  const std::uint32_t count = std::min(points.dim, kMostProjected);
  const double left = 2.0 * kMargin + kPanel, cell = static_cast<double>(kMatrix) / (count - 1);
  for (std::uint32_t row = 1; row < count; ++row)
    for (std::uint32_t column = 0; column < row; ++column) {
      const Box box{left + column * cell + 5, kTitle + (row - 1) * cell + 5, cell - 10, cell - 10};
      draw_points(canvas, box, points, column, row);
      if (column == 0)
        canvas.text(left - 14, box.top + box.height / 2 - 4, 1, fmt::format("x{}", row + 1), kText);
      if (row + 1 == count)
        canvas.text(box.left + box.width / 2 - 6, kTitle + kMatrix + 4, 1,
                    fmt::format("x{}", column + 1), kText);
    }
  draw_caption(canvas, {left, kTitle, 0, 0},
               fmt::format("projections of the first {} coordinates", count));
}

}  // namespace

Canvas draw_quality(const PointSet& points, const Quality& quality, const std::string& title) {
  const bool planar = points.dim == 2;
  const int width = kMargin + kPanel + kMargin +
                    (planar            ? 2 * kPanel + 2 * kMargin
                     : points.dim == 1 ? 0
                                       : kMatrix + kMargin);
  const int height = kTitle + (points.dim > 2 ? kMatrix : kPanel) + kMargin;
  Canvas canvas(width, height);
  canvas.text(kMargin, 14, 2, title, kInk);
  const Box box{kMargin, kTitle, kPanel, kPanel};
  draw_points(canvas, box, points, 0, points.dim == 1 ? 0 : 1);
  draw_caption(canvas, box, points.dim == 1 ? "x1, and the index upwards" : "x1, x2 upwards");
  if (planar) draw_planar(canvas, quality);
  if (points.dim > 2) draw_projections(canvas, points);
  return canvas;
}

}  // namespace koksma
