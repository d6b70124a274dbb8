// The values that an entry's checks and cases give to parameters and choices.
#include <fmt/format.h>

#include <catch2/catch.hpp>

#include "error/error.hpp"
#include "tests/support.hpp"

using namespace koksma;
using Catch::Matchers::Contains;

namespace {

// What loading says of a user's copy of sum-x with this entry; empty: it loads.
std::string refusal(Json entry) {
  const test::TemporaryFolder folder;
  entry["name"] = "mine";
  folder.write("mine.cl", test::repository_file("integrands/product/sum-x.cl"));
  try {
    load_catalog({folder.write("mine.json", entry.dump())});
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("values of checks and cases name parameters and choices that there are", "[unit]") {
  const Json good = Json::parse(test::repository_file("integrands/product/sum-x.json"));
  CHECK(refusal(good).empty());
  for (const char* key : {"checks", "sample_checks", "stability"}) {
    Json entry = good;
    entry[key][0]["parameters"]["no_such"] = 1;
    CHECK_THAT(refusal(entry), Contains(fmt::format("at '/{}/0/parameters'", key)) &&
                                   Contains("unknown parameter 'no_such'"));
  }
  Json entry = good;
  entry["choices"] = {{{"name", "form"},
                       {"allowed", {"stable", "naive"}},
                       {"default", "stable"},
                       {"meaning", "of the expression"}}};
  entry["checks"][0]["parameters"]["form"] = "naive";
  CHECK(refusal(entry).empty());
  entry["checks"][0]["parameters"]["form"] = "naiv";
  CHECK_THAT(refusal(entry), Contains("unknown value of form 'naiv'") && Contains("'naive'"));
  entry["checks"][0]["parameters"]["form"] = 2;
  CHECK_THAT(refusal(entry), Contains("form = 2") && Contains("a choice one of its values"));
}
