// Finished cells on disk, one JSON line each, written before anything else happens to them: a kill
// or a full disk loses nothing that was measured. `--resume` takes them back.
#pragma once

#include <fstream>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "catalog/json.hpp"

namespace koksma {

class Journal {
 public:
  // Opens RESULTS_PATH.journal.jsonl. `context` tells runs apart (device, program, input files):
  // with `resume` the cells of a journal of the same context are taken over. A journal that is not
  // is set aside under a free name. InputError if the file cannot be written or another run has it
  // open.
  Journal(const std::string& results_path, const Json& context, bool resume);

  // The finished cell with this identity, if the journal has it.
  std::optional<Json> finished(const Json& identity) const;
  // Appends and flushes; throws std::runtime_error when the disk takes no more.
  void append(const Json& identity, const Json& cell);
  // What was appended of this cell does not count. Throws as append does.
  void withdraw(const Json& identity);
  // The results file is complete: the journal goes, unless it holds cells taken over that no one
  // asked for (finished()); then it stays.
  void remove();
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  const std::string& path() const { return path_; }
  std::size_t taken_over() const { return taken_over_; }
  // Where an earlier journal went that was not taken over; empty if there was none.
  const std::string& set_aside() const { return set_aside_; }

 private:
  void lock();
  void unlock();
  void read(const std::string& text, const Json& context);

  std::string path_, lock_path_, set_aside_;
  int lock_ = -1;
  std::ofstream file_;
  std::map<std::string, Json> cells_;
  mutable std::set<std::string> unclaimed_;  // taken over, not yet asked for
  std::size_t taken_over_ = 0;
};

// Writes text to a temporary name beside `path` and renames it: a reader never sees half a file.
// InputError naming the path when that is impossible.
void write_file_atomically(const std::string& path, const std::string& text);

// InputError where write_file_atomically would throw one; leaves nothing behind. For asking before
// the work is done.
void check_writable(const std::string& path);

}  // namespace koksma
