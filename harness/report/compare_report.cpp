#include "report/compare_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>

#include "journal/cell_json.hpp"
#include "report/text_table.hpp"

namespace koksma {
namespace {

using Line = std::vector<std::string>;

std::string_view name(CellState state) {
  static constexpr std::array<std::string_view, 6> kNames{"compared", "vanished", "failed",
                                                          "repaired", "added",    "idle"};
  return kNames.at(static_cast<std::size_t>(state));
}

std::string_view name(Change change) {
  static constexpr std::array<std::string_view, 5> kNames{"none", "better", "worse", "undecided",
                                                          "unknown"};
  return kNames.at(static_cast<std::size_t>(change));
}

std::string time_text(const TimeChange& time) {
  return time.ratio > 0 ? fmt::format("{:.3f}", time.ratio) : "-";
}

std::string p_text(const TimeChange& time) {
  return time.ratio > 0 ? fmt::format("{:.1e}", time.p) : "-";
}

std::string time_words(const TimeChange& time) {
  if (time.change == Change::worse) return "SLOWER";
  if (time.change == Change::better) return "faster";
  if (time.change == Change::undecided) return "undecided";
  return time.ratio > 0 ? "" : time.reason;
}

std::string value_text(const std::optional<double>& value) {
  return value ? fmt::format("{:.2e}", *value) : "-";
}

std::string error_words(const ErrorChange& error) {
  if (error.change == Change::worse) return fmt::format("ERROR WORSE: {}", error.reason);
  if (error.change == Change::better) return fmt::format("error better: {}", error.reason);
  return error.suspect ? "intervals do not overlap, but may by chance" : "";
}

bool worth_a_line(const RowChange& row) {
  return row.time.change == Change::worse || row.time.change == Change::better ||
         row.time.change == Change::undecided || row.error.change == Change::worse ||
         row.error.change == Change::better || row.error.suspect || !row.vanished.empty();
}

std::string cell_words(const CellChange& cell) {
  switch (cell.state) {
    case CellState::vanished:
      return fmt::format("VANISHED: {}", cell.reason);
    case CellState::failed:
      return fmt::format("FAILED: {}", cell.reason);
    case CellState::repaired:
      return "runs now";
    case CellState::added:
      return "new";
    case CellState::idle:
      return fmt::format("in neither: {}", cell.reason);
    case CellState::compared:
      break;
  }
  const auto worse = std::count_if(cell.rows.begin(), cell.rows.end(), [](const RowChange& row) {
    return row.time.change == Change::worse || row.error.change == Change::worse ||
           !row.vanished.empty();
  });
  std::string words = time_words(cell.time);
  if (worse > 0)
    words +=
        fmt::format("{}{} row{} worse", words.empty() ? "" : "; ", worse, worse == 1 ? "" : "s");
  return words;
}

Line cell_line(const CellChange& cell) {
  return {cell.name, "", time_text(cell.time), p_text(cell.time), "", "", cell_words(cell)};
}

Line row_line(const RowChange& row) {
  std::string words =
      row.vanished.empty() ? time_words(row.time) : fmt::format("VANISHED: {}", row.vanished);
  const std::string error = error_words(row.error);
  if (!error.empty() && row.vanished.empty()) words += (words.empty() ? "" : "; ") + error;
  return {"",
          size_text(row.n),
          time_text(row.time),
          p_text(row.time),
          value_text(row.error.base),
          value_text(row.error.now),
          words};
}

const Line kHeading{"cell", "N", "time new/base", "p", "RMSE base", "RMSE new", ""};

std::vector<Line> lines_of(const CellChange& cell) {
  std::vector<Line> lines{cell_line(cell)};
  for (const RowChange& row : cell.rows)
    if (worth_a_line(row)) lines.push_back(row_line(row));
  return lines;
}

std::string verdict(const Comparison& c) {
  const auto worse = std::count_if(c.cells.begin(), c.cells.end(),
                                   [](const CellChange& cell) { return cell.regression(); });
  if (!c.regression())
    return c.undecided() ? "no regression, but changes that are UNDECIDED" : "no regression";
  std::string text = "REGRESSION:";
  if (c.study.change == Change::worse) text += " the study as a whole is slower";
  if (worse > 0)
    text += fmt::format("{} {} of {} cells", c.study.change == Change::worse ? "," : "", worse,
                        c.cells.size());
  return text;
}

std::string calibration_text(const Comparison& c) {
  if (!c.calibration_followed) return "";
  return fmt::format(
      "; the calibration kernel itself: {:.2f}, followed by {:.2f} of it; the device itself: "
      "{:.2f}",
      c.calibration_ratio, *c.calibration_followed, c.clock_ratio);
}

std::string summary(const Comparison& c) {
  std::string text;
  if (c.rows_timed > 0)
    text += fmt::format(
        "times new/base of {} rows in {} cells: median {} (p {}; spread of rows {:.0f} %, of cells "
        "{:.0f} %{})\n",
        c.rows_timed, c.cells_timed, time_text(c.study), p_text(c.study), 100 * c.row_spread,
        100 * c.cell_spread, calibration_text(c));
  else
    text += fmt::format("times: not compared, {}\n", c.study.reason);
  return text + fmt::format("errors of {} rows\n", c.rows_with_errors);
}

std::string limits(const Comparison& c) {
  return fmt::format(
      "A time counts as changed beyond {:g} %, a rank test and the spread; the tests of all rows, "
      "of all "
      "cells and of the\nstudy share a false-alarm probability of {:g}, errors another.",
      100 * c.options.threshold, c.options.alpha);
}

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '|') result += '\\';
    result += c;
  }
  return result;
}

std::string markdown_table(const std::vector<Line>& lines) {
  std::string text;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    for (const std::string& field : lines[i]) text += fmt::format("| {} ", escaped(field));
    text += "|\n";
    if (i == 0) text += "|---|---|---:|---:|---:|---:|---|\n";
  }
  return text;
}

Json time_json(const TimeChange& time) {
  return {{"change", name(time.change)},
          {"ratio", time.ratio > 0 ? Json(time.ratio) : Json(nullptr)},
          {"p", time.ratio > 0 ? Json(time.p) : Json(nullptr)},
          {"reason", time.reason}};
}

Json error_json(const ErrorChange& error) {
  return {{"change", name(error.change)},
          {"base", error.base ? Json(*error.base) : Json(nullptr)},
          {"new", error.now ? Json(*error.now) : Json(nullptr)},
          {"suspect", error.suspect},
          {"reason", error.reason}};
}

Json cell_json(const CellChange& cell) {
  Json json = {
      {"name", cell.name},     {"state", name(cell.state)},    {"regression", cell.regression()},
      {"reason", cell.reason}, {"time", time_json(cell.time)}, {"rows", Json::array()}};
  for (const RowChange& row : cell.rows)
    json["rows"].push_back({{"n", row.n},
                            {"time", time_json(row.time)},
                            {"error", error_json(row.error)},
                            {"vanished", row.vanished}});
  return json;
}

}  // namespace

std::string compare_table(const Comparison& comparison) {
  std::vector<Line> lines{kHeading};
  for (const CellChange& cell : comparison.cells)
    for (Line& line : lines_of(cell)) lines.push_back(std::move(line));
  std::string text = text_table(lines) + "\n";
  for (const std::string& note : comparison.notes) text += fmt::format("{}\n", note);
  return fmt::format("{}{}{}\n{}\n", text, summary(comparison), limits(comparison),
                     verdict(comparison));
}

std::string compare_markdown(const Comparison& comparison) {
  std::vector<Line> changed{kHeading}, same{kHeading};
  for (const CellChange& cell : comparison.cells) {
    const std::vector<Line> lines = lines_of(cell);
    const bool plain = lines.size() == 1 && lines.front().back().empty();
    for (const Line& line : lines) (plain ? same : changed).push_back(line);
  }
  std::string text = fmt::format("**koksma compare: {}**\n\n", verdict(comparison));
  for (const std::string& note : comparison.notes) text += fmt::format("- {}\n", note);
  if (!comparison.notes.empty()) text += "\n";
  text += fmt::format("{}\n", summary(comparison));
  if (changed.size() > 1) text += markdown_table(changed) + "\n";
  if (same.size() > 1)
    text += fmt::format("<details><summary>{} cells without change</summary>\n\n{}\n</details>\n\n",
                        same.size() - 1, markdown_table(same));
  return text + limits(comparison) + "\n";
}

Json compare_json(const Comparison& comparison) {
  Json json = {
      {"schema_version", kCompareSchemaVersion},
      {"regression", comparison.regression()},
      {"undecided", comparison.undecided()},
      {"threshold", comparison.options.threshold},
      {"alpha", comparison.options.alpha},
      {"base", comparison.base},
      {"new", comparison.now},
      {"notes", comparison.notes},
      {"rows_timed", comparison.rows_timed},
      {"cells_timed", comparison.cells_timed},
      {"calibration_followed", number_or_null(comparison.calibration_followed)},
      {"clock_ratio", comparison.clock_ratio},
      {"clock_explains", {comparison.explained.low, comparison.explained.high}},
      {"clock_explains_of_one",
       {comparison.explained_of_one.low, comparison.explained_of_one.high}},
      {"rows_with_errors", comparison.rows_with_errors},
      {"row_spread", comparison.row_spread},
      {"cell_spread", comparison.cell_spread},
      {"study_spread", comparison.study_spread},
      {"calibration_ratio",
       comparison.calibration_ratio > 0 ? Json(comparison.calibration_ratio) : Json(nullptr)},
      {"study", time_json(comparison.study)},
      {"cells", Json::array()}};
  for (const CellChange& cell : comparison.cells) json["cells"].push_back(cell_json(cell));
  check_schema(json, "results/compare.schema.json", "koksma compare");
  return json;
}

}  // namespace koksma
