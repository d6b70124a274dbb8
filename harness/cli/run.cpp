// koksma run: study -> plans -> build everything -> time everything -> journal -> results.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>

#include "cli/input_files.hpp"
#include "cli/verbs.hpp"
#include "device/calibration.hpp"
#include "device/check_integrand.hpp"
#include "error/error.hpp"
#include "estimate/measure.hpp"
#include "journal/journal.hpp"
#include "report/results.hpp"
#include "report/table.hpp"
#include "stability/eft.hpp"

namespace koksma {
namespace {

struct RunOptions {
  std::string study, device, out, directions;
  std::vector<std::string> integrands;
  StudyFlags flags;
  bool resume = false, quiet = false;
};

using Clock = std::chrono::steady_clock;

// Between passes over a cell, where others are timed: disturbances of a machine last for 1 to 3 s.
constexpr std::chrono::milliseconds kBetweenPasses{1500};

// One cell on its way: taken from the journal, ready to run, or refused with a reason.
struct Slot {
  Json identity;
  std::optional<Json> json;
  std::unique_ptr<PreparedCell> prepared;
  bool begun = false, kept = false;    // kept: in the journal
  std::optional<Reference> reference;  // of errors, once begun
};

struct Turn {  // of a cell that was begun
  std::size_t cell;
  Clock::time_point due;
};

class Run {
 public:
  Run(const RunOptions& options, const Catalog& catalog, const Study& study, Device& device,
      Journal& journal)
      : options_(options),
        catalog_(catalog),
        study_(study),
        device_(device),
        journal_(journal),
        self_test_(catalog, device),
        progress_(stderr, study.cells.size(), options.quiet) {
    for (const Cell& cell : study.cells) rows_ += most_rows(cell);
  }

  // JSON of every cell, in the study's order.
  Json cells() {
    Device exact_device = Device::choose_exact(device_);
    find_unknown_integrals(exact_device);
    for (const Cell& cell : study_.cells) slots_.push_back(prepare(cell, exact_device));
    for (const auto& [scene, candidates] : unknown_) measure_reference(scene, candidates);
    for (std::size_t i = 0; i < slots_.size(); ++i) {
      if (!slots_[i].begun) begin(i);
      take_turns(false);
    }
    take_turns(true);
    progress_.clear();
    std::vector<Json> cells;
    for (Slot& slot : slots_) cells.push_back(std::move(*slot.json));
    return cells;
  }

  bool failed() const { return failed_; }

 private:
  // Rows that the cell may have, whenever it stops: they share the false-alarm probability.
  std::size_t most_rows(const Cell& cell) const {
    const Sampler sampler = catalog_.sampler(cell.sampler, "sampler");
    std::size_t rows = cell.n.size();
    for (auto n = next_size(sampler, cell, cell.n.back()); n; n = next_size(sampler, cell, *n))
      ++rows;
    return rows;
  }

  // Scenes whose integral nobody knows, with their cells, the best promise first.
  void find_unknown_integrals(Device& exact_device) {
    std::map<std::string, bool> unknown;
    for (std::size_t i = 0; i < study_.cells.size(); ++i) {
      const Scene& scene = study_.cells[i].scene;
      const auto [place, fresh] = unknown.try_emplace(scene.text);
      if (fresh) {
        const Integrand& f = catalog_.integrand(scene.integrand, "scene");
        place->second = is_unknown(exact_device, f, scene);
      }
      if (place->second) unknown_[scene.text].push_back(i);
    }
    for (auto& [scene, candidates] : unknown_)
      candidates = by_promise(catalog_, study_.cells, candidates);
  }

  static bool is_unknown(Device& exact_device, const Integrand& f, const Scene& scene) {
    try {
      const ExactValues exact = compute_exact(exact_device, f, scene);
      return !exact.mean && !exact.mean_undefined;
    } catch (const BuildError&) {  // the cell's own row will tell
      return false;
    }
  }

  // Runs cells of a scene until one gives an estimate, which the others are then measured against.
  void measure_reference(const std::string& scene, const std::vector<std::size_t>& candidates) {
    for (const std::size_t i : candidates) {
      begin(i);
      if (const auto found = reference_from(*slots_[i].json)) {
        references_[scene] = *found;
        return;
      }
    }
  }

  // What decides a cell's numbers, and so whether a journal's cell is this one: of a scene without
  // a known integral also the cell that errors are against.
  Json identity_of(const Cell& cell) const {
    Json identity = cell_identity(cell);
    if (const auto found = unknown_.find(cell.scene.text); found != unknown_.end())
      identity["reference"] = cell_identity(study_.cells[found->second.front()]);
    return identity;
  }

  Slot prepare(const Cell& cell, Device& exact_device) {
    Slot slot;
    slot.identity = identity_of(cell);
    if (const auto finished = journal_.finished(slot.identity)) {
      slot.json = *finished;
      return slot;
    }
    progress_.stage(fmt::format("building {} with {}", cell.scene.text, cell.sampler));
    try {
      if (catalog_.integrand(cell.scene.integrand, "scene").users_own)
        check_user_integrand(catalog_, device_, exact_device, cell);
      Plan plan = make_plan(catalog_, cell, device_.facts(), options_.directions);
      self_test_.require(plan);
      slot.prepared =
          std::make_unique<PreparedCell>(catalog_, device_, exact_device, std::move(plan));
    } catch (const UnsupportedError& error) {
      slot.json = cell_to_json(catalog_, refused_cell(cell, CellStatus::unsupported, error.what()),
                               nullptr);
    } catch (const InputError&) {
      throw;
    } catch (const std::exception& error) {  // a cell that fails, for want of memory too, is a row
      fail(slot, cell, error.what());
    }
    return slot;
  }

  std::optional<Reference> reference_of(const Cell& cell) const {
    const auto found = references_.find(cell.scene.text);
    return found == references_.end() ? std::nullopt : std::optional(found->second);
  }

  void fail(Slot& slot, const Cell& cell, const std::string& reason) {
    failed_ = true;
    progress_.clear();
    fmt::print(stderr, "koksma: {} with {}: {}\n", cell.scene.text, cell.sampler, reason);
    slot.json = cell_to_json(catalog_, refused_cell(cell, CellStatus::failed, reason), nullptr);
  }

  // Work on a cell that is on its way. What it throws becomes the cell's row, and what the journal
  // has of it does not count.
  template <typename Work>
  void attempt(std::size_t i, const Work& work) {
    Slot& slot = slots_[i];
    if (slot.prepared == nullptr) return;
    try {
      work(*slot.prepared);
    } catch (const std::exception& error) {
      fail(slot, study_.cells[i], error.what());
      slot.prepared.reset();
      if (slot.kept) journal_.withdraw(slot.identity);
    }
  }

  // Starts the cell, keeps what is known of it, as others may take hours, and leaves it to be timed
  // again, in turn with them.
  void begin(std::size_t i) {
    Slot& slot = slots_[i];
    const Cell& cell = study_.cells[i];
    slot.begun = true;
    slot.reference = reference_of(cell);
    attempt(i, [&](PreparedCell& prepared) {
      progress_.stage(fmt::format("{} with {}", cell.scene.text, cell.sampler));
      prepared.start(slot.reference);
      while (slots_.size() == 1 && prepared.unfinished()) prepared.time_again();
    });
    record(i);
    progress_.finished(
        fmt::format("{} with {}: {}", cell.scene.text, cell.sampler, outcome_text(*slot.json)));
    go_on_with(i);
  }

  void record(std::size_t i) {
    Slot& slot = slots_[i];
    attempt(i, [&](PreparedCell& prepared) {
      const CellResult result = prepared.result(rows_, slot.reference);
      slot.json = cell_to_json(catalog_, result, &prepared.plan());
    });
    if (slot.prepared == nullptr) return;
    journal_.append(slot.identity, *slot.json);
    slot.kept = true;
  }

  void go_on_with(std::size_t i) {
    auto& prepared = slots_[i].prepared;
    if (prepared != nullptr && prepared->unfinished())
      turns_.push_back({i, Clock::now() + kBetweenPasses});
    else
      prepared.reset();
  }

  // Of cells whose turn has come, or `all` as if it had.
  void take_turns(bool all) {
    while (!turns_.empty() && (all || turns_.front().due <= Clock::now())) {
      const std::size_t i = turns_.front().cell;
      turns_.pop_front();
      attempt(i, [](PreparedCell& prepared) { prepared.time_again(); });
      if (slots_[i].prepared != nullptr && !slots_[i].prepared->unfinished()) record(i);
      go_on_with(i);
    }
  }

  const RunOptions& options_;
  const Catalog& catalog_;
  const Study& study_;
  Device& device_;
  Journal& journal_;
  EftSelfTest self_test_;
  Progress progress_;
  std::vector<Slot> slots_;
  std::deque<Turn> turns_;                                   // the first to come first
  std::map<std::string, std::vector<std::size_t>> unknown_;  // by scene: cells
  std::map<std::string, Reference> references_;              // by scene
  std::size_t rows_ = 0;                                     // of all cells
  bool failed_ = false;
};

int run(const RunOptions& options, const std::string& command_line) {
  std::future<Device> loading = Device::choose_beside(options.device);
  const Catalog catalog = load_catalog(options.integrands);
  StudyFlags flags = options.flags;
  flags.own_directions = !options.directions.empty();
  const Study study = read_study(catalog, options.study, flags);
  std::string out = options.out;
  if (out.empty()) {
    out = "results/latest.json";
    std::error_code ignored;
    std::filesystem::create_directories("results", ignored);
  }
  check_writable(out);
  check_directions(catalog, study, options.directions);
  Device device = loading.get();
  check_sampler_files(catalog, study, device.facts());

  Json context = make_context(device.facts(), study, command_line);
  context["calibration"] = Calibration::identity(device.facts());
  Json same_context = resume_context(context);
  const Json files = input_files(catalog, study, options.integrands, options.directions);
  if (!files.is_null()) same_context["files"] = files;
  Journal journal(out, same_context, options.resume);
  if (!options.quiet && journal.taken_over() > 0)
    fmt::print(stderr, "{} finished cells taken over from {}\n", journal.taken_over(),
               journal.path());
  if (!journal.set_aside().empty())
    fmt::print(stderr, "an earlier journal, of another program, device or input, is kept as {}\n",
               journal.set_aside());

  Run work(options, catalog, study, device, journal);
  const Json results = make_results(context, work.cells());
  write_results(results, out);
  journal.remove();
  if (!options.quiet) fmt::print("{}\nresults: {}\n", results_table(results), out);
  return work.failed() ? kCellFailed : kAllOk;
}

// CLI11's own says "not in range" up to the largest double, digit by digit.
CLI::Validator above_zero() {
  return {[](std::string& text) {
            double value = 0;
            const bool is_number = CLI::detail::lexical_cast(text, value);
            if (is_number && value > 0 && std::isfinite(value)) return std::string();
            return fmt::format("found '{}', allowed is a finite number above 0", text);
          },
          ""};
}

}  // namespace

void add_run(CLI::App& app, Action& action, const std::string& command_line) {
  auto options = std::make_shared<RunOptions>();
  CLI::App* verb = app.add_subcommand(
      "run", "Run a study: error against N and against time, as a table and as JSON");
  verb->add_option("study", options->study, "study file; without one, the default study")
      ->option_text("STUDY.json");
  verb->add_option("--scene", options->flags.scenes,
                   "NAME or NAME:d=8,key=value (see koksma list scenes); repeatable")
      ->allow_extra_args(false);
  verb->add_option("--sampler", options->flags.samplers,
                   "NAME or NAME:key=value (see koksma list samplers); repeatable")
      ->allow_extra_args(false);
  verb->add_option("--estimator", options->flags.estimator,
                   "see koksma list estimators; default: what fits the sampler");
  verb->add_option("--n", options->flags.n,
                   "sample counts: 2^8..2^20, 1000, or a list with commas");
  verb->add_option("--replicates", options->flags.replicates, "independent randomizations per N")
      ->check(CLI::Range(1, 65536));
  verb->add_option("--launches", options->flags.launches,
                   "timed launches of a row, at most; 1 where its time matters less; default: what "
                   "20 ms take, at least 3 unless they take 60 ms, at most 16")
      ->check(CLI::Range(1, 16));
  verb->add_option("--precision", options->flags.precision,
                   "fp32 or fp64; default: fp64 where the device has it")
      ->check(CLI::IsMember({"fp32", "fp64"}));
  verb->add_option("--sum", options->flags.sum, "summation algorithm (see koksma list sums)");
  verb->add_option("--seed", options->flags.seed, "seed of all randomizations")
      ->check(CLI::Range(std::uint64_t{0}, kLargestSeed));
  verb->add_option("--time-budget", options->flags.time_budget,
                   "seconds per cell: N goes up, beyond --n too, until the next row would exceed "
                   "them; no row is cut")
      ->option_text("SECONDS")
      ->check(above_zero());
  verb->add_option("--until", options->flags.until,
                   "stop a cell at this RMSE relative to |I| (absolute where I = 0); N goes up, "
                   "beyond --n too, until it is reached")
      ->option_text("RELERR")
      ->check(above_zero());
  verb->add_option("--device", options->device,
                   "P:D or part of a name (see koksma list devices); default: PoCL");
  verb->add_option("--out", options->out, "results file; default: results/latest.json")
      ->option_text("FILE.json");
  verb->add_option("--integrand", options->integrands,
                   "an integrand of your own: F.json with F.cl beside it; repeatable")
      ->allow_extra_args(false);
  verb->add_option("--directions", options->directions,
                   "Sobol' direction numbers in Joe and Kuo's format")
      ->option_text("FILE");
  verb->add_flag("--resume", options->resume, "take over the finished cells of an interrupted run");
  verb->add_flag("--quiet", options->quiet, "no table and no progress");
  verb->callback([options, &action, command_line] {
    action = [options, command_line] { return run(*options, command_line); };
  });
}

}  // namespace koksma
