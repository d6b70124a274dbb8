// The embedded entries against their schemas: checked here, and not at every start of the program.
#include <catch2/catch.hpp>
#include <set>
#include <string_view>

#include "catalog/embedded.hpp"
#include "catalog/json.hpp"
#include "catalog/read_entry.hpp"
#include "tests/support.hpp"

using namespace koksma;

TEST_CASE("every embedded entry follows its schema, and every .json of them is an entry",
          "[unit]") {
  std::set<std::string_view> used;
  for (const EmbeddedFile& file : embedded_files()) {
    INFO(file.path);
    const std::string_view schema = entry_schema(file.path);
    if (schema.empty()) {
      const bool is_json_of_the_catalog =
          file.path.ends_with(".json") &&
          (file.path.starts_with("kernels/") || file.path.starts_with("integrands/"));
      CHECK(!is_json_of_the_catalog);
      continue;
    }
    used.insert(schema);
    CHECK_NOTHROW(check_schema(parse_json(file.text, file.path), schema, file.path));
  }
  // No schema of the catalog is left without an entry that it checks.
  for (const EmbeddedFile& file : embedded_files())
    if (file.path.starts_with("harness/catalog/") && file.path.ends_with(".schema.json")) {
      INFO(file.path);
      CHECK(used.count(file.path) == 1);
    }
}
