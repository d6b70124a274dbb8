#include "report/compare_context.hpp"

#include <fmt/format.h>

#include <utility>

namespace koksma {
namespace {

std::string text_at(const Json& context, const char* pointer) {
  const Json value = context.value(Json::json_pointer(pointer), Json());
  return value.is_string() ? value.get<std::string>() : value.dump();
}

bool same(const Json& base, const Json& now, const char* pointer) {
  return text_at(base, pointer) == text_at(now, pointer);
}

}  // namespace

bool same_device(const Json& base, const Json& now) {
  return same(base, now, "/device/name") && same(base, now, "/device/vendor") &&
         same(base, now, "/device/platform") && same(base, now, "/device/compute_units");
}

bool same_calibration(const Json& base, const Json& now) {
  return same(base, now, "/calibration") &&
         (base.contains("calibration") || same(base, now, "/revision"));
}

std::vector<std::string> context_notes(const Json& base, const Json& now,
                                       const CompareOptions& options) {
  std::vector<std::string> notes;
  if (!same_device(base, now))
    notes.push_back(options.across_devices
                        ? "the devices differ; times are compared as asked for"
                        : "the devices differ: times are not compared (--across-devices does)");
  else if (!same_calibration(base, now))
    notes.push_back(options.across_devices
                        ? "the calibration kernels differ: times are compared as they are"
                        : "the calibration kernels differ: times are not compared; run the base "
                          "with this koksma");
  for (const auto& [pointer, what] :
       {std::pair{"/device/name", "device"}, std::pair{"/device/compute_units", "compute units"},
        std::pair{"/device/driver", "driver"}, std::pair{"/device/version", "OpenCL version"},
        std::pair{"/host", "host"}, std::pair{"/build_type", "build type"},
        std::pair{"/compiler", "compiler"}, std::pair{"/version", "version of koksma"},
        std::pair{"/environment", "environment"}, std::pair{"/seed", "seed"}})
    if (!same(base, now, pointer))
      notes.push_back(
          fmt::format("{}: {}, was {}", what, text_at(now, pointer), text_at(base, pointer)));
  return notes;
}

}  // namespace koksma
