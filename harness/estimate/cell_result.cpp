#include "estimate/cell_result.hpp"

namespace koksma {

CellResult refused_cell(const Cell& cell, CellStatus status, const std::string& reason) {
  CellResult result;
  result.cell = cell;
  result.status = status;
  result.reason = reason;
  result.rate.reason = "the cell did not run";
  result.verdict.verdict = "no-rate";
  result.verdict.reason = result.rate.reason;
  result.stopped.reason = result.rate.reason;
  result.stability.reason = result.rate.reason;
  return result;
}

}  // namespace koksma
