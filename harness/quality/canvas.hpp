// A small anti-aliased canvas: dots, lines, rectangles and short texts, written as PNG. Coverage is
// blended in linear light and encoded as sRGB at the end.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace koksma {

struct Colour {
  float red = 0, green = 0, blue = 0;  // linear, 0 ... 1
};

// A grey whose sRGB value is `display`, 0 ... 1.
Colour grey(double display);

// Coordinates in pixels from the top left corner; pixel (i, j) covers [i, i+1) x [j, j+1).
class Canvas {
 public:
  Canvas(int width, int height);

  void dot(double x, double y, double radius, const Colour& colour);
  void line(double x0, double y0, double x1, double y1, double width, const Colour& colour);
  void fill(double x0, double y0, double x1, double y1, const Colour& colour);
  // A square image of columns x columns colours, [row from the top][column], every pixel the mean
  // of what it covers: fills one by one would let the background through at their seams.
  void image(double x0, double y0, double size, std::size_t columns,
             const std::vector<Colour>& colours);
  // One pixel wide, outside [x0, x1) x [y0, y1).
  void frame(double x0, double y0, double x1, double y1, const Colour& colour);
  // Capitals are 7 scale pixels high; y is their top.
  void text(double x, double y, double scale, std::string_view words, const Colour& colour);
  static double text_width(double scale, std::string_view words);

  std::string png() const;
  // Pixels' worth of black: the sum of 1 - green.
  double ink() const;

 private:
  void blend(int x, int y, double coverage, const Colour& colour);
  // Blends over the box, where coverage(x, y) is that of the pixel with this centre.
  template <typename Coverage>
  void paint(double x0, double y0, double x1, double y1, const Colour& colour, Coverage&& coverage);

  int width_, height_;
  std::vector<Colour> pixels_;
};

}  // namespace koksma
