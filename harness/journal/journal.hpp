// Finished cells on disk, one JSON line each, written before anything else happens to them: a kill
// or a full disk loses nothing that was measured. `--resume` takes them back.
#pragma once

#include <fstream>
#include <map>
#include <optional>
#include <string>

#include "catalog/json.hpp"

namespace koksma {

class Journal {
 public:
  // Opens RESULTS_PATH.journal.jsonl. `context` tells runs apart (device, revision of the program,
  // study seed): with `resume` the cells of a journal of the same context are taken over, any other
  // journal is replaced. InputError if the file cannot be written.
  Journal(const std::string& results_path, const Json& context, bool resume);

  // The finished cell with this identity, if the journal has it.
  std::optional<Json> finished(const Json& identity) const;
  // Appends and flushes; DeviceError-free: throws std::runtime_error when the disk takes no more.
  void append(const Json& identity, const Json& cell);
  // The results file is complete: the journal goes.
  void remove();

  const std::string& path() const { return path_; }
  std::size_t taken_over() const { return taken_over_; }

 private:
  void read(const std::string& text, const Json& context);

  std::string path_;
  std::ofstream file_;
  std::map<std::string, Json> cells_;
  std::size_t taken_over_ = 0;
};

// Writes text to a temporary name beside `path` and renames it: a reader never sees half a file.
// InputError naming the path when that is impossible.
void write_file_atomically(const std::string& path, const std::string& text);

// InputError where write_file_atomically would throw one; leaves nothing behind. For asking before
// the work is done.
void check_writable(const std::string& path);

}  // namespace koksma
