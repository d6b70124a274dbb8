// The terminal's view of results: a table of cells, and progress while they run.
#pragma once

#include <chrono>
#include <cstdio>
#include <string>

#include "catalog/json.hpp"

namespace koksma {

// One line per cell: error at the largest N, rate with its interval, time, throughput, marks; then
// a legend.
std::string results_table(const Json& results);

// The RMSE of a cell's last row, or its status where it has none.
std::string outcome_text(const Json& cell);

// A bar with the time left on a terminal, a plain line per finished cell elsewhere, nothing when
// quiet.
class Progress {
 public:
  Progress(std::FILE* stream, std::size_t total, bool quiet);
  void stage(const std::string& text);          // what is going on now
  void finished(const std::string& cell_line);  // one more cell is done
  void clear();                                 // removes the bar

 private:
  void draw(const std::string& text);

  std::FILE* stream_;
  std::size_t total_, done_ = 0;
  bool quiet_, terminal_;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace koksma
