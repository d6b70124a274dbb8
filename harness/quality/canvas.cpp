#include "quality/canvas.hpp"

#include <stb/stb_easy_font.h>
#include <stb/stb_image_write.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace koksma {
namespace {

// IEC 61966-2-1.
double to_linear(double display) {
  return display <= 0.04045 ? display / 12.92 : std::pow((display + 0.055) / 1.055, 2.4);
}

std::uint8_t to_byte(double linear) {
  const double display =
      linear <= 0.0031308 ? linear * 12.92 : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
  return static_cast<std::uint8_t>(std::lround(255 * std::clamp(display, 0.0, 1.0)));
}

}  // namespace

Colour grey(double display) {
  const auto value = static_cast<float>(to_linear(std::clamp(display, 0.0, 1.0)));
  return {value, value, value};
}

Canvas::Canvas(int width, int height)
    : width_(width),
      height_(height),
      pixels_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), Colour{1, 1, 1}) {
}

void Canvas::blend(int x, int y, double coverage, const Colour& colour) {
  if (x < 0 || y < 0 || x >= width_ || y >= height_ || coverage <= 0) return;
  Colour& pixel = pixels_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                          static_cast<std::size_t>(x)];
  const auto a = static_cast<float>(std::min(coverage, 1.0));
  pixel.red += a * (colour.red - pixel.red);
  pixel.green += a * (colour.green - pixel.green);
  pixel.blue += a * (colour.blue - pixel.blue);
}

template <typename Coverage>
void Canvas::paint(double x0, double y0, double x1, double y1, const Colour& colour,
                   Coverage&& coverage) {
  const int left = std::max(0, static_cast<int>(std::floor(x0)));
  const int top = std::max(0, static_cast<int>(std::floor(y0)));
  for (int y = top; y < std::min<double>(height_, y1); ++y)
    for (int x = left; x < std::min<double>(width_, x1); ++x)
      blend(x, y, coverage(x + 0.5, y + 0.5), colour);
}

void Canvas::dot(double x, double y, double radius, const Colour& colour) {
  const double reach = radius + 1;
  // A disk smaller than a pixel keeps its ink: it is drawn one pixel wide and fainter.
  const double drawn = std::max(radius, 0.5),
               ink = std::min(1.0, radius * radius / (drawn * drawn));
  paint(x - reach, y - reach, x + reach, y + reach, colour, [&](double px, double py) {
    return ink * std::clamp(drawn + 0.5 - std::hypot(px - x, py - y), 0.0, 1.0);
  });
}

void Canvas::line(double x0, double y0, double x1, double y1, double width, const Colour& colour) {
  const double dx = x1 - x0, dy = y1 - y0, square = dx * dx + dy * dy, reach = width / 2 + 1;
  paint(std::min(x0, x1) - reach, std::min(y0, y1) - reach, std::max(x0, x1) + reach,
        std::max(y0, y1) + reach, colour, [&](double px, double py) {
          const double along =
              square > 0 ? std::clamp(((px - x0) * dx + (py - y0) * dy) / square, 0.0, 1.0) : 0;
          const double off = std::hypot(px - x0 - along * dx, py - y0 - along * dy);
          return std::clamp(width / 2 + 0.5 - off, 0.0, 1.0);
        });
}

void Canvas::fill(double x0, double y0, double x1, double y1, const Colour& colour) {
  const auto overlap = [](double centre, double low, double high) {
    return std::clamp(std::min(centre + 0.5, high) - std::max(centre - 0.5, low), 0.0, 1.0);
  };
  paint(x0, y0, x1, y1, colour,
        [&](double px, double py) { return overlap(px, x0, x1) * overlap(py, y0, y1); });
}

void Canvas::image(double x0, double y0, double size, std::size_t columns,
                   const std::vector<Colour>& colours) {
  const double scale = static_cast<double>(columns) / size;
  const auto cell = [&](double at) {
    return static_cast<std::size_t>(std::clamp(at, 0.0, static_cast<double>(columns) - 1));
  };
  const auto pixels = static_cast<int>(size);
  for (int row = 0; row < pixels; ++row)
    for (int column = 0; column < pixels; ++column) {
      const double u0 = column * scale, u1 = u0 + scale, v0 = row * scale, v1 = v0 + scale;
      Colour mean;
      for (std::size_t v = cell(v0); v <= cell(v1); ++v)
        for (std::size_t u = cell(u0); u <= cell(u1); ++u) {
          const auto x = static_cast<double>(u), y = static_cast<double>(v);
          const double area = std::max(0.0, std::min(x + 1, u1) - std::max(x, u0)) *
                              std::max(0.0, std::min(y + 1, v1) - std::max(y, v0));
          const auto share = static_cast<float>(area / (scale * scale));
          mean.red += share * colours[v * columns + u].red;
          mean.green += share * colours[v * columns + u].green;
          mean.blue += share * colours[v * columns + u].blue;
        }
      blend(static_cast<int>(x0) + column, static_cast<int>(y0) + row, 1, mean);
    }
}

void Canvas::frame(double x0, double y0, double x1, double y1, const Colour& colour) {
  fill(x0 - 1, y0 - 1, x1 + 1, y0, colour);
  fill(x0 - 1, y1, x1 + 1, y1 + 1, colour);
  fill(x0 - 1, y0, x0, y1, colour);
  fill(x1, y0, x1 + 1, y1, colour);
}

void Canvas::text(double x, double y, double scale, std::string_view words, const Colour& colour) {
  std::string copy(words);
  // The font is made of rectangles: four vertices of 16 bytes each, x and y first.
  constexpr std::size_t kVertex = 16, kQuad = 4 * kVertex;
  std::vector<char> quads(copy.size() * 64 * kVertex + kQuad);
  const int count =
      stb_easy_font_print(0, 0, copy.data(), nullptr, quads.data(), static_cast<int>(quads.size()));
  for (int q = 0; q < count; ++q) {
    float corner[2][2];  // of the first and the third vertex
    std::memcpy(corner[0], &quads[static_cast<std::size_t>(q) * kQuad], sizeof(corner[0]));
    std::memcpy(corner[1], &quads[static_cast<std::size_t>(q) * kQuad + 2 * kVertex],
                sizeof(corner[1]));
    fill(x + scale * corner[0][0], y + scale * corner[0][1], x + scale * corner[1][0],
         y + scale * corner[1][1], colour);
  }
}

double Canvas::text_width(double scale, std::string_view words) {
  std::string copy(words);
  return scale * stb_easy_font_width(copy.data());
}

double Canvas::ink() const {
  double sum = 0;
  for (const Colour& p : pixels_) sum += 1 - static_cast<double>(p.green);
  return sum;
}

std::string Canvas::png() const {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(pixels_.size() * 3);
  for (const Colour& p : pixels_)
    for (const float channel : {p.red, p.green, p.blue}) bytes.push_back(to_byte(channel));
  std::string file;
  stbi_write_png_to_func(
      [](void* context, void* data, int size) {
        static_cast<std::string*>(context)->append(static_cast<const char*>(data),
                                                   static_cast<std::size_t>(size));
      },
      &file, width_, height_, 3, bytes.data(), width_ * 3);
  return file;
}

}  // namespace koksma
