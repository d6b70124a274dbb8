#include "journal/journal.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <sstream>

#include "error/error.hpp"

namespace koksma {
namespace {

constexpr const char* kWritable = "give a path in a folder that exists and can be written";

std::string existing_text(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  if (file) text << file.rdbuf();
  return text.str();
}

std::string line_of(const Json& identity, const Json& cell) {
  return dumped(Json{{"identity", identity}, {"cell", cell}}) + "\n";
}

// The first of PATH.1, PATH.2, … that is free.
std::string free_name(const std::string& path) {
  int number = 1;
  while (std::filesystem::exists(fmt::format("{}.{}", path, number))) ++number;
  return fmt::format("{}.{}", path, number);
}

bool holds_cells(const std::string& text) {
  return text.find("\n{\"identity\"") != std::string::npos;
}

}  // namespace

Journal::Journal(const std::string& results_path, const Json& context, bool resume)
    : path_(results_path + ".journal.jsonl"), lock_path_(results_path + ".lock") {
  lock();
  const std::string before = existing_text(path_);
  if (resume) read(before, context);
  if (cells_.empty() && holds_cells(before)) {
    set_aside_ = free_name(path_);
    std::filesystem::rename(path_, set_aside_);
  }
  // Cells taken over are written before the old journal goes, so a kill here loses nothing either.
  std::string kept = dumped(Json{{"context", context}}) + "\n";
  for (const auto& [identity, cell] : cells_) kept += line_of(Json::parse(identity), cell);
  write_file_atomically(path_, kept);
  file_.open(path_, std::ios::binary | std::ios::app);
}

Journal::~Journal() { unlock(); }

void Journal::unlock() {
  if (lock_ < 0) return;
  unlink(lock_path_.c_str());
  close(lock_);
  lock_ = -1;
}

// Two runs with one results file would destroy each other's journal.
void Journal::lock() {
  lock_ = open(lock_path_.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0644);
  if (lock_ < 0)
    throw InputError(lock_path_, fmt::format("cannot write: {}", std::strerror(errno)), kWritable);
  if (flock(lock_, LOCK_EX | LOCK_NB) == 0) return;
  close(lock_);
  lock_ = -1;
  throw InputError(lock_path_, "another run is writing these results", "give another --out");
}

void Journal::read(const std::string& text, const Json& context) {
  std::istringstream lines(text);
  std::string line;
  bool same_context = false;
  while (std::getline(lines, line)) {
    const Json entry = Json::parse(line, nullptr, false);
    if (entry.is_discarded()) continue;  // the line a kill cut short
    if (entry.contains("context")) same_context = entry["context"] == context;
    if (!same_context || !entry.contains("identity") || !entry.contains("cell")) continue;
    const std::string identity = entry["identity"].dump();
    if (entry["cell"].is_null())
      cells_.erase(identity);  // withdrawn
    else
      cells_[identity] = entry["cell"];
  }
  for (const auto& [identity, cell] : cells_) unclaimed_.insert(identity);
  taken_over_ = cells_.size();
}

std::optional<Json> Journal::finished(const Json& identity) const {
  const auto found = cells_.find(identity.dump());
  unclaimed_.erase(identity.dump());
  return found == cells_.end() ? std::nullopt : std::optional(found->second);
}

void Journal::append(const Json& identity, const Json& cell) {
  cells_[identity.dump()] = cell;
  file_ << line_of(identity, cell);
  file_.flush();
  if (!file_)
    throw std::runtime_error(fmt::format("{}: cannot write: {}", path_, std::strerror(errno)));
}

void Journal::withdraw(const Json& identity) {
  append(identity, nullptr);
  cells_.erase(identity.dump());
}

void Journal::remove() {
  file_.close();
  unlock();
  if (!unclaimed_.empty()) return;
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
}

void write_file_atomically(const std::string& path, const std::string& text) {
  const std::string temporary = path + ".new";
  errno = 0;
  std::ofstream file(temporary, std::ios::binary | std::ios::trunc);
  const bool opened = file.is_open();
  file << text;
  file.close();
  std::error_code error;
  if (file) std::filesystem::rename(temporary, path, error);
  if (!file || error) {
    const std::string why = error ? error.message() : std::strerror(errno);
    if (opened) std::filesystem::remove(temporary, error);
    throw InputError(path, fmt::format("cannot write: {}", why), kWritable);
  }
}

void check_writable(const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored))
    throw InputError(path, "cannot write: it is a folder", kWritable);
  // What write_file_atomically will do, short of replacing the file.
  const std::string temporary = path + ".new";
  errno = 0;
  if (!std::ofstream(temporary, std::ios::binary | std::ios::app))
    throw InputError(path, fmt::format("cannot write: {}", std::strerror(errno)), kWritable);
  std::filesystem::remove(temporary, ignored);
}

}  // namespace koksma
