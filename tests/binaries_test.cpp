// Kept programs: an earlier run's binaries are taken only when they are whole and the same
// program's, results are the same bits with them, and everything is built before the first timed
// launch.
#include "device/binaries.hpp"

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>

#include "device/cache.hpp"
#include "estimate/measure.hpp"
#include "tests/support.hpp"

using namespace koksma;
using Catch::Matchers::Contains;

namespace {

namespace fs = std::filesystem;

ProgramSource program(int answer) {
  return {"answer",
          "__kernel void answer(__global int *out) { *out = " + std::to_string(answer) + "; }",
          "-cl-std=CL1.2 -w"};
}

// What the kernel of a built program writes.
int answer_of(Device& device, const cl::Program& built) {
  cl::Kernel kernel(built, "answer");
  const cl::Buffer out = device.allocate(sizeof(cl_int));
  kernel.setArg(0, out);
  device.queue().enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(1), cl::NDRange(1));
  cl_int value = 0;
  device.queue().enqueueReadBuffer(out, CL_TRUE, 0, sizeof value, &value);
  return value;
}

void overwrite(const std::string& path, const std::string& text) {
  std::ofstream(path, std::ios::binary | std::ios::trunc) << text;
}

std::string file_in(const std::string& folder) {
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.path().extension() == ".program") return entry.path().string();
  return "";
}

}  // namespace

TEST_CASE("a kept program is found by its text, options and device, and by nothing else",
          "[device]") {
  const test::TemporaryFolder folder;
  const test::KeepingOn keeping(folder.path("cache"));
  Device first = Device::choose("");
  CHECK_FALSE(first.build(program(41)).kept);
  Device second = Device::choose("");
  const BuiltProgram again = second.build(program(41));
  CHECK(again.kept);
  CHECK(answer_of(second, again.program) == 41);
  CHECK_FALSE(second.build(program(42)).kept);
  ProgramSource other = program(41);
  other.options += " -DOTHER=1";
  CHECK_FALSE(second.build(other).kept);
  const cl::Device here = second.context().getInfo<CL_CONTEXT_DEVICES>().front();
  const KeptPrograms elsewhere(folder.path("cache/koksma/programs"), "another driver");
  CHECK_FALSE(elsewhere.find(second.context(), here, program(41)));
}

TEST_CASE(
    "a kept program that is cut short, changed, another's or empty is built anew and replaced",
    "[device]") {
  const test::TemporaryFolder folder;
  const test::KeepingOn keeping(folder.path("cache"));
  Device::choose("").build(program(43));
  const std::string path = file_in(folder.path("cache"));
  REQUIRE_FALSE(path.empty());
  const std::string whole = read_text_file(path);
  Device::choose("").build(program(44));
  std::string another;
  for (const auto& entry : fs::directory_iterator(fs::path(path).parent_path()))
    if (entry.path() != path) another = read_text_file(entry.path().string());
  REQUIRE(another != whole);

  std::string flipped = whole;
  flipped[whole.size() - 100] ^= 1;
  for (const std::string& damaged :
       {flipped, another, whole.substr(0, whole.size() - 1), whole.substr(0, whole.size() / 2),
        whole + "x", whole.substr(0, whole.find('\n') + 1), std::string("not ours\n"),
        std::string()}) {
    overwrite(path, damaged);
    Device device = Device::choose("");
    const BuiltProgram built = device.build(program(43));
    CHECK_FALSE(built.kept);
    CHECK(answer_of(device, built.program) == 43);
    CHECK(Device::choose("").build(program(43)).kept);  // written anew
  }
}

TEST_CASE("programs are not kept where keeping is off, or where nothing can be written",
          "[device]") {
  const test::TemporaryFolder folder;
  {
    const test::CacheAt cache(folder.path("cache"));  // the tests' KOKSMA_KEPT=off
    Device::choose("").build(program(45));
    CHECK_FALSE(fs::exists(folder.path("cache/koksma/programs")));
  }
  folder.write("file", "");
  const test::KeepingOn keeping(folder.path("file"));
  for (int run = 0; run < 2; ++run) CHECK_FALSE(Device::choose("").build(program(45)).kept);
}

TEST_CASE("results are the same bits with kept programs", "[device]") {
  const test::TemporaryFolder folder;
  const test::KeepingOn keeping(folder.path("cache"));
  for (const char* sampler : {"random", "sobol-owen"}) {
    const Cell cell = test::cell("genz-gaussian:d=2", sampler, 1 << 12, 4);
    std::vector<Row> rows;
    for (int run = 0; run < 2; ++run) {
      Device device = Device::choose("");
      Plan plan = make_plan(test::catalog(), cell, device.facts());
      const ProgramSource source = plan.program;
      PreparedCell prepared(test::catalog(), device, device, std::move(plan));
      rows.push_back(prepared.run_row(cell.n.front()));
      Device next = Device::choose("");
      CHECK(next.build(source).kept);
    }
    CHECK(rows[0].estimate.value == rows[1].estimate.value);
    CHECK(rows[0].errors.rmse == rows[1].errors.rmse);
  }
}

TEST_CASE("nothing is built once the cells of a study are prepared", "[device]") {
  const Study study = read_study(test::catalog(), "", {});
  Device device = Device::choose("");
  std::vector<std::unique_ptr<PreparedCell>> cells;
  for (Cell cell : study.cells) {
    if (cell.scene.text != study.cells.front().scene.text) continue;
    cell.n = {256, 1 << 12, 1 << 16};
    cells.push_back(std::make_unique<PreparedCell>(
        test::catalog(), device, device, make_plan(test::catalog(), cell, device.facts())));
  }
  REQUIRE(cells.size() > 3);
  const std::size_t before = device.programs_built();
  REQUIRE(before > 3);
  for (auto& cell : cells) cell->run();
  CHECK(device.programs_built() == before);
}

TEST_CASE("a run prepares every cell before it times the first", "[device]") {
  const test::TemporaryFolder folder;
  const auto run = test::run_command(
      "run --scene genz-gaussian:d=2 --sampler random --sampler sobol-owen --n 2^8 --out " +
      folder.path("out.json"));
  REQUIRE(run.status == 0);
  const auto last_build = run.output.rfind("building "), first_cell = run.output.find("[1/2]");
  REQUIRE(last_build != std::string::npos);
  REQUIRE(first_cell != std::string::npos);
  CHECK(last_build < first_cell);
}
