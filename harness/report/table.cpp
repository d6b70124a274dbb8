#include "report/table.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <bit>

#include "report/text_table.hpp"

namespace koksma {
namespace {

constexpr double kGlance = 1e-3;  // the tolerance in the table

std::string slope_text(const Json& slope, const Json& interval) {
  if (!slope.is_number()) return "-";
  if (!interval.is_array()) return fmt::format("{:.2f}", slope.get<double>());
  const double half = (interval[1].get<double>() - interval[0].get<double>()) / 2;
  return fmt::format("{:.2f} ± {:.2f}", slope.get<double>(), half);
}

// Where the variance is infinite there is no rate of the RMSE, only one of the median.
std::string rate_text(const Json& convergence) {
  const bool of_median = !convergence["rate"].is_number() && convergence["median_rate"].is_number();
  return of_median ? slope_text(convergence["median_rate"], convergence["median_interval"])
                   : slope_text(convergence["rate"], convergence["interval"]);
}

// Kernel time of one replicate to a relative error of 1e-3, "~" where it is beyond the rows.
std::string glance_text(const Json& cell) {
  for (const Json& t : cell["efficiency"]["time_to_tolerance"])
    if (t["tolerance"] == kGlance && t["seconds"].is_number())
      return fmt::format("{}{:.1e}", t["extrapolated"] == true ? "~" : "",
                         t["seconds"].get<double>());
  return "-";
}

// Below 10 two digits, above whole numbers.
std::string ratio_text(const Json& ratio) {
  if (!ratio.is_number()) return "-";
  const double value = ratio.get<double>();
  return fmt::format(fmt::runtime(value < 10    ? "{:.2g}"
                                  : value < 1e5 ? "{:.0f}"
                                                : "{:.0e}"),
                     value);
}

std::string marks(const Json& cell, const Json& row) {
  std::string text;
  const auto add = [&](const std::string& mark) { text += (text.empty() ? "" : " ") + mark; };
  const Json& stability = cell["stability"];
  // That of the gate is told below.
  if (stability["verdict"].is_string() && stability["verdict"] != "OK" &&
      stability["verdict"] != "OUTSIDE_GATE")
    add(stability["verdict"]);
  for (const Json& mark : stability["marks"]) add(mark);
  if (stability["verdict"] == "PLATEAU_NUMERIC" && stability["floors"]["dominant"].is_string())
    add(fmt::format("floor: {}", stability["floors"]["dominant"].get<std::string>()));
  if (stability["ode"].is_object() && stability["ode"]["relative_bias"].is_number())
    add(fmt::format("integrator bias {:+.2g} %",
                    100 * stability["ode"]["relative_bias"].get<double>()));
  if (stability["infinite_variance"] == true)
    add(cell["convergence"]["median_rate"].is_number() ? "infinite variance: rate of the median"
                                                       : "infinite variance");
  if (row["heavy_tailed"] == true || cell["convergence"]["heavy_tailed"] == true)
    add("heavy-tailed");
  if (row["nonfinite"].get<std::uint64_t>() > 0)
    add(fmt::format("non-finite:{}", row["nonfinite"].get<std::uint64_t>()));
  if (row["grid_limited"] == true) add("grid-limited");
  if (row["error_against"] == "own best estimate") add("own-estimate");
  if (row["below_reference"] == true)
    add("below the reference's error");
  else if (!row["error_reason"].get<std::string>().empty())
    add(row["error_reason"].get<std::string>());
  if (cell["stopped"].is_object() && cell["stopped"]["by"] != "study")
    add(fmt::format("stopped: {}", cell["stopped"]["by"].get<std::string>()));
  const std::string verdict = cell["convergence"]["verdict"];
  if (verdict == "within-gate" || verdict == "outside-gate") add(verdict);
  if (verdict == "no-rate" && !cell["convergence"]["reason"].get<std::string>().empty())
    add("no rate: " + cell["convergence"]["reason"].get<std::string>());
  return text;
}

std::vector<std::string> cell_columns(const Json& cell) {
  std::vector<std::string> columns{
      cell["scene"]["text"], cell["sampler"], cell["estimator"],
      cell["precision"].is_string() ? cell["precision"].get<std::string>() : "-"};
  if (cell["status"] != "ok" || cell["rows"].empty()) {
    const std::string reason = cell["reason"];  // that of a compiler has many lines
    columns.push_back(fmt::format("{}: {}", cell["status"].get<std::string>(),
                                  reason.substr(0, reason.find('\n'))));
    return columns;
  }
  const Json& row = cell["rows"].back();
  columns.push_back(size_text(row["n"]));
  columns.push_back(number_text(row["rmse"]));
  columns.push_back(number_text(row["median_abs_error"]));
  columns.push_back(rate_text(cell["convergence"]));
  columns.push_back(number_text(cell["convergence"]["expected"], "{:.2f}"));
  columns.push_back(glance_text(cell));
  columns.push_back(ratio_text(row["speed_up"]));
  columns.push_back(fmt::format("{:.3g}", row["seconds_per_replicate"].get<double>() * 1e3));
  columns.push_back(row["coordinates_per_s"].is_number()
                        ? fmt::format("{:.2f}", row["coordinates_per_s"].get<double>() * 1e-9)
                        : "-");
  columns.push_back(marks(cell, row));
  return columns;
}

constexpr const char* kTableLegend =
    "error: RMSE and median |e| of single N-point estimates at the largest N. rate: slope of log2 "
    "RMSE, ± half its 95 %\n"
    "interval; theory: the expected slope, log factors left out. s to 1e-3: kernel seconds of one "
    "replicate to that error\n"
    "relative to |I| (absolute where I = 0) on the fitted line, ~ beyond its rows. x mc: how many "
    "times the time plain Monte\n"
    "Carlo takes to the same error. ms: kernel time of one replicate. Gcoord/s: 1e9 coordinates "
    "generated, evaluated and\nsummed per second. heavy-tailed: believe the median, not "
    "the RMSE.\n"
    "In capitals: the verdict on the cell, where it is not OK, and its marks; `stability` in the "
    "results file says why.\nfloor: what keeps the error from falling.\n";

constexpr const char* kOwnEstimateLegend =
    "own-estimate: the integral is not known; errors are against the run's own best estimate, "
    "named "
    "in the results as\n\"reference\" with its standard error; an RMSE below 3 of those is below "
    "the reference's error.\n";

}  // namespace

std::string results_table(const Json& results) {
  std::vector<std::vector<std::string>> lines{{"scene", "sampler", "est.", "prec", "N", "RMSE",
                                               "med|e|", "rate", "theory", "s to 1e-3", "x mc",
                                               "ms", "Gcoord/s", ""}};
  for (const Json& cell : results["cells"]) lines.push_back(cell_columns(cell));
  const std::string text = text_table(lines);
  for (const Json& cell : results["cells"])
    if (cell["reference"].is_object()) return text + "\n" + kTableLegend + kOwnEstimateLegend;
  return text + "\n" + kTableLegend;
}

std::string outcome_text(const Json& cell) {
  const Json& rows = cell["rows"];
  if (rows.empty() || !rows.back()["rmse"].is_number()) return cell["status"];
  return fmt::format("RMSE {:.2e}", rows.back()["rmse"].get<double>());
}

Progress::Progress(std::FILE* stream, std::size_t total, bool quiet)
    : stream_(stream),
      total_(total),
      quiet_(quiet),
      terminal_(isatty(fileno(stream)) != 0),
      start_(std::chrono::steady_clock::now()) {}

void Progress::draw(const std::string& text) {
  constexpr std::size_t kWidth = 30;
  const std::size_t filled = total_ == 0 ? kWidth : done_ * kWidth / total_;
  std::string left;
  if (done_ > 0) {
    const double spent =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    left = fmt::format(" {:.0f} s left",
                       spent / static_cast<double>(done_) * static_cast<double>(total_ - done_));
  }
  fmt::print(stream_, "\r\033[K[{}{}] {}/{}{}  {}", std::string(filled, '#'),
             std::string(kWidth - filled, '.'), done_, total_, left, text);
  std::fflush(stream_);
}

void Progress::stage(const std::string& text) {
  if (quiet_) return;
  if (terminal_)
    draw(text);
  else
    fmt::print(stream_, "{}\n", text);
}

void Progress::finished(const std::string& cell_line) {
  ++done_;
  if (quiet_) return;
  if (terminal_)
    draw(cell_line);
  else
    fmt::print(stream_, "[{}/{}] {}\n", done_, total_, cell_line);
}

void Progress::clear() {
  if (!quiet_ && terminal_) fmt::print(stream_, "\r\033[K");
}

}  // namespace koksma
