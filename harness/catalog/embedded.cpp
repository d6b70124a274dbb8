#include "catalog/embedded.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace koksma {

std::string_view embedded_text(std::string_view path) {
  const auto files = embedded_files();
  const auto found = std::find_if(files.begin(), files.end(),
                                  [&](const EmbeddedFile& f) { return f.path == path; });
  if (found == files.end()) throw std::out_of_range("no embedded file " + std::string(path));
  return found->text;
}

}  // namespace koksma
