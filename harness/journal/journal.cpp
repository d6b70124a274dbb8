#include "journal/journal.hpp"

#include <fmt/format.h>

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

}  // namespace

Journal::Journal(const std::string& results_path, const Json& context, bool resume)
    : path_(results_path + ".journal.jsonl") {
  if (resume) read(existing_text(path_), context);
  // Cells taken over are written before the old journal goes, so a kill here loses nothing either.
  std::string kept = dumped(Json{{"context", context}}) + "\n";
  for (const auto& [identity, cell] : cells_) kept += line_of(Json::parse(identity), cell);
  write_file_atomically(path_, kept);
  file_.open(path_, std::ios::binary | std::ios::app);
}

void Journal::read(const std::string& text, const Json& context) {
  std::istringstream lines(text);
  std::string line;
  bool same_context = false;
  while (std::getline(lines, line)) {
    const Json entry = Json::parse(line, nullptr, false);
    if (entry.is_discarded()) continue;  // the line a kill cut short
    if (entry.contains("context")) same_context = entry["context"] == context;
    if (same_context && entry.contains("identity") && entry.contains("cell"))
      cells_[entry["identity"].dump()] = entry["cell"];
  }
  taken_over_ = cells_.size();
}

std::optional<Json> Journal::finished(const Json& identity) const {
  const auto found = cells_.find(identity.dump());
  return found == cells_.end() ? std::nullopt : std::optional(found->second);
}

void Journal::append(const Json& identity, const Json& cell) {
  cells_[identity.dump()] = cell;
  file_ << line_of(identity, cell);
  file_.flush();
  if (!file_)
    throw std::runtime_error(fmt::format("{}: cannot write: {}", path_, std::strerror(errno)));
}

void Journal::remove() {
  file_.close();
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
