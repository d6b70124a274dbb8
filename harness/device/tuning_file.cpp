#include "device/tuning_file.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>

#include "catalog/embedded.hpp"
#include "device/cache.hpp"
#include "error/error.hpp"

namespace koksma {
namespace {

constexpr int kTuningFormat = 1;
constexpr const char* kAgain = "koksma tune measures again";

// Other kernels may like other shapes.
std::string hash_of_kernels() {
  std::uint64_t hash = fnv1a("");
  for (const EmbeddedFile& file : embedded_files())
    if (file.path.ends_with(".cl")) hash = fnv1a(file.text, hash);
  return fmt::format("{:016x}", hash);
}

Json device_json(const DeviceFacts& d) {
  return {{"name", d.name},       {"vendor", d.vendor}, {"platform", d.platform},
          {"version", d.version}, {"driver", d.driver}, {"compute_units", d.compute_units}};
}

TimedShape shape_from(const Json& json) {
  TimedShape t;
  t.family = json["family"];
  t.precision = json["precision"] == "fp32" ? Precision::fp32 : Precision::fp64;
  t.shape = {json["lanes_per_item"], json["local_size"], std::nullopt,
             json["items_per_launch"].get<std::uint64_t>()};
  t.seconds = json["seconds"];
  return t;
}

}  // namespace

std::string tuning_file(const DeviceFacts& device) {
  const std::string folder = cache_folder();
  const std::string who = fmt::format("{}|{}|{}", device.platform, device.name, device.driver);
  return folder.empty() ? "" : fmt::format("{}/tuning-{:016x}.json", folder, fnv1a(who));
}

std::shared_ptr<const Tuning> read_tuning(const DeviceFacts& device) {
  const std::string path = tuning_file(device);
  std::error_code ignored;
  if (path.empty() || !std::filesystem::exists(path, ignored)) return nullptr;
  const Json json = parse_json(read_text_file(path), path);
  check_schema(json, "harness/device/tuning.schema.json", path);
  if (json["device"] != device_json(device))
    throw InputError(path, "measured on another device or driver", kAgain);
  if (json["kernels"] != hash_of_kernels())
    throw InputError(path, "measured with other kernels", kAgain);
  auto tuning = std::make_shared<Tuning>();
  tuning->date = json["date"];
  for (const Json& timed : json["timed"]) tuning->timed.push_back(shape_from(timed));
  return tuning;
}

std::shared_ptr<const Tuning> usable_tuning(const DeviceFacts& device) {
  try {
    return read_tuning(device);
  } catch (const InputError& error) {
    fmt::print(stderr, "koksma: a tuning is ignored: {}\n", error.what());
    return nullptr;
  }
}

bool write_tuning(const DeviceFacts& device, const Tuning& tuning) {
  Json json;
  json["koksma_tuning"] = kTuningFormat;
  json["date"] = tuning.date;
  json["kernels"] = hash_of_kernels();
  json["device"] = device_json(device);
  for (const TimedShape& t : tuning.timed)
    json["timed"].push_back(
        {{"family", t.family},
         {"precision", precision_name(t.precision)},
         {"lanes_per_item", t.shape.lanes_per_item},
         {"local_size", t.shape.local_size},
         {"items_per_launch", t.shape.items_per_launch.value_or(kItemsPerLaunch)},
         {"seconds", t.seconds}});
  return replace_file(tuning_file(device), dumped(json, 1) + "\n");
}

}  // namespace koksma
