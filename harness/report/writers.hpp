// Results in the formats of other tools.
//   google-benchmark: what Google Benchmark writes with --benchmark_format=json (its docs/tools.md
//   and
//     json_reporter.cc), for compare.py and whatever else reads it.
//   chart: [{name, unit, value, range, extra}], smaller is better: what CI history charts read
//     (github-action-benchmark, customSmallerIsBetter).
#pragma once

#include <string>
#include <vector>

#include "catalog/json.hpp"

namespace koksma {

// One entry per row, one with error_message per cell that is not ok. real_time: median kernel time
// of a launch, ns, as with manual time; cpu_time: its wall time; counters: the rest that is a
// number.
Json google_benchmark_json(const Json& results);

// Two entries per row: median kernel time in us (range: half the interquartile range) and RMSE
// (range: half its confidence interval).
Json chart_json(const Json& results);

// The names that write_report knows.
std::vector<std::string> report_formats();

// Results in that format, as text. InputError naming --format and what is allowed.
std::string report_text(const Json& results, const std::string& format);

}  // namespace koksma
