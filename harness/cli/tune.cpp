// koksma tune: times launch shapes on a device, prints what was tried and what is gained, and keeps
// it in the user's cache folder for all later runs.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "cli/verbs.hpp"
#include "device/tuner.hpp"
#include "device/tuning_file.hpp"
#include "error/error.hpp"
#include "report/text_table.hpp"

namespace koksma {
namespace {

struct TuneOptions {
  std::string device;
  bool show = false, forget = false;
};

// What plans take from the tuning, for the kernel that was timed for a family and precision.
ShapeChoice chosen(const Catalog& catalog, const TuningWork& work, const DeviceFacts& device,
                   const TimedShape& timed) {
  for (const TuningWork::Kernel& kernel : work.kernels) {
    const Sampler sampler = catalog.sampler(kernel.sampler, "tune");
    if (sampler.family != timed.family) continue;
    const Scene scene = parse_scene(catalog, kernel.scene, "tune");
    return choose_shape(device, {&sampler, &catalog.integrand(scene.integrand, "tune"), scene.dim,
                                 timed.precision, 1});
  }
  return {};
}

bool same(const LaunchShape& a, const LaunchShape& b) {
  return a.lanes_per_item == b.lanes_per_item && a.local_size == b.local_size &&
         a.items_per_launch.value_or(kItemsPerLaunch) ==
             b.items_per_launch.value_or(kItemsPerLaunch);
}

void print_tuning(const Catalog& catalog, const DeviceFacts& device) {
  const TuningWork work = tuning_work(device);
  DeviceFacts untuned = device;
  untuned.tuning = nullptr;
  std::vector<std::vector<std::string>> lines{
      {"prec", "points", "lanes", "local size", "items/launch", "ms", "speed", ""}};
  for (const TimedShape& t : device.tuning->timed) {
    const LaunchShape usual = chosen(catalog, work, untuned, t).shape;
    const ShapeChoice choice = chosen(catalog, work, device, t);
    const auto base = std::find_if(
        device.tuning->timed.begin(), device.tuning->timed.end(), [&](const TimedShape& other) {
          return other.family == t.family && other.precision == t.precision &&
                 same(other.shape, usual);
        });
    const bool is_usual = same(t.shape, usual), is_chosen = same(t.shape, choice.shape);
    lines.push_back(
        {std::string(precision_name(t.precision)), t.family,
         fmt::format("{}", t.shape.lanes_per_item), fmt::format("{}", t.shape.local_size),
         fmt::format("{}", t.shape.items_per_launch.value_or(kItemsPerLaunch)),
         fmt::format("{:.3f}", t.seconds * 1e3),
         base == device.tuning->timed.end() ? "" : fmt::format("{:.2f}", base->seconds / t.seconds),
         fmt::format("{}{}", is_usual ? "default" : "",
                     !is_chosen ? ""
                     : is_usual ? ", kept"
                                : "chosen")});
  }
  fmt::print("{}\n", text_table(lines));
  fmt::print(
      "speed: of the default shape. A shape is chosen where it is more than {:.0f} % faster than "
      "the "
      "default.\nResults are the same bits either way; widths 1 and 4 to 16 are exchanged only for "
      "integrands of exact operations.\n",
      kLeastGain * 100);
}

int show(const DeviceFacts& device) {
  const std::string path = tuning_file(device);
  DeviceFacts facts = device;
  try {
    facts.tuning = read_tuning(device);
  } catch (const InputError& error) {
    fmt::print("a tuning that is ignored: {}\n", error.what());
    return kAllOk;
  }
  if (facts.tuning == nullptr) {
    fmt::print("{} has no tuning: launch shapes are the defaults\n", device.name);
    return kAllOk;
  }
  fmt::print("{}, tuned on {}, in {}\n", device.name, facts.tuning->date, path);
  print_tuning(load_catalog(), facts);
  return kAllOk;
}

int forget(const DeviceFacts& device) {
  const std::string path = tuning_file(device);
  std::error_code failed;
  const bool gone = !path.empty() && std::filesystem::remove(path, failed);
  if (failed)
    throw InputError(path, fmt::format("cannot be removed: {}", failed.message()),
                     "remove the file by hand");
  fmt::print("{}\n",
             gone ? fmt::format("removed {}", path) : fmt::format("{} has no tuning", device.name));
  return kAllOk;
}

int measure(Device& device) {
  const std::string path = tuning_file(device.facts());
  const Catalog catalog = load_catalog();
  const Tuning tuning =
      tune(device, catalog, tuning_work(device.facts()),
           [](const std::string& what) { fmt::print(stderr, "timing {}\n", what); });
  const bool kept = write_tuning(device.facts(), tuning);
  DeviceFacts facts = device.facts();
  facts.tuning = std::make_shared<const Tuning>(tuning);
  fmt::print("{}\n", facts.name);
  print_tuning(catalog, facts);
  if (!kept)
    throw InputError(path.empty() ? "koksma tune" : path, "the tuning can not be kept",
                     "set HOME or XDG_CACHE_HOME to a folder that can be written");
  fmt::print("kept in {}, which is safe to delete (koksma tune --forget)\n", path);
  return kAllOk;
}

int tune_verb(const TuneOptions& options) {
  Device device = Device::choose(options.device);
  if (options.show) return show(device.facts());
  if (options.forget) return forget(device.facts());
  return measure(device);
}

}  // namespace

void add_tune(CLI::App& app, Action& action) {
  auto options = std::make_shared<TuneOptions>();
  CLI::App* verb = app.add_subcommand(
      "tune",
      "Time launch shapes on a device (lanes per work-item, work-group size, items per launch) and "
      "keep the fastest for later runs; results stay the same bits");
  verb->add_option("--device", options->device,
                   "P:D or part of a name (see koksma list devices); default: PoCL");
  auto* show_flag = verb->add_flag("--show", options->show, "print what was measured before");
  verb->add_flag("--forget", options->forget, "remove it: the default shapes again")
      ->excludes(show_flag);
  verb->callback([options, &action] { action = [options] { return tune_verb(*options); }; });
}

}  // namespace koksma
