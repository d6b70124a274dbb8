// koksma points: the coordinates themselves, as .csv (17 digits) or .npy (NumPy's format 1.0).
#include <fmt/format.h>

#include <bit>
#include <filesystem>
#include <fstream>

#include "cli/verbs.hpp"
#include "device/points_dump.hpp"
#include "error/error.hpp"
#include "journal/journal.hpp"
#include "study/study.hpp"

namespace koksma {
namespace {

struct PointsOptions {
  std::string sampler, n, precision, out, device, directions;
  std::uint32_t dim = 0, replicate = 0;
  std::uint64_t start = 0, seed = 1;
};

constexpr std::uint64_t kValuesAtOnce = std::uint64_t{1} << 20;

void write_npy_header(std::ofstream& file, std::uint64_t rows, std::uint32_t columns, bool fp64) {
  std::string header = fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({}, {}), }}",
                                   fp64 ? "<f8" : "<f4", rows, columns);
  const std::size_t preamble = 10;  // magic, version, length
  header += std::string(63 - (preamble + header.size()) % 64, ' ') + "\n";
  const auto length = static_cast<std::uint16_t>(header.size());
  file << "\x93NUMPY" << '\x01' << '\x00' << static_cast<char>(length & 0xFF)
       << static_cast<char>(length >> 8) << header;
}

void write_npy(std::ofstream& file, const std::vector<double>& values, bool fp64) {
  if (fp64) {
    file.write(reinterpret_cast<const char*>(values.data()),
               static_cast<std::streamsize>(values.size() * sizeof(double)));
    return;
  }
  const std::vector<float> narrow(values.begin(), values.end());
  file.write(reinterpret_cast<const char*>(narrow.data()),
             static_cast<std::streamsize>(narrow.size() * sizeof(float)));
}

void write_csv(std::ofstream& file, const std::vector<double>& values, std::uint32_t dim) {
  fmt::memory_buffer text;
  for (std::size_t i = 0; i < values.size(); ++i)
    fmt::format_to(std::back_inserter(text), "{:.17g}{}", values[i],
                   (i + 1) % dim == 0 ? '\n' : ',');
  file.write(text.data(), static_cast<std::streamsize>(text.size()));
}

// Points of a set that is not extensible are those of the set of N points, from --start on.
std::uint64_t end_of(const PointsOptions& options, const Sampler& sampler, std::uint64_t count) {
  return sampler.extensible ? options.start + count : count;
}

void check(const PointsOptions& options, const Sampler& sampler, std::uint64_t count) {
  if (options.dim < sampler.min_dim ||
      (options.dim > sampler.max_dim && (options.directions.empty() || !sampler.reads_directions)))
    throw InputError("--dim", fmt::format("{}", options.dim),
                     fmt::format("sampler '{}' has {} to {} dimensions", sampler.name,
                                 sampler.min_dim, sampler.max_dim));
  const std::uint64_t limit = std::uint64_t{1} << sampler.max_log2_n;
  if (options.start >= limit || count > limit - options.start)
    throw InputError("--n, --start",
                     fmt::format("points {} to {}", options.start, options.start + count - 1),
                     fmt::format("sampler '{}' has 2^{} points", sampler.name, sampler.max_log2_n));
  // From --start on it is a piece of a set, and may have any length.
  if (options.start == 0 || !sampler.extensible) check_size(sampler, options.dim, count, "--n");
  if (!sampler.extensible && options.start >= count)
    throw InputError(
        "--start", fmt::format("{}", options.start),
        fmt::format("each N of sampler '{}' is a set of its own: below --n", sampler.name));
  if (options.replicate > 0 && !sampler.replicable)
    throw InputError("--replicate", fmt::format("{}", options.replicate),
                     fmt::format("sampler '{}' is not randomized: only 0", sampler.name));
}

int points(const PointsOptions& options) {
  const bool npy = options.out.ends_with(".npy");
  if (!npy && !options.out.ends_with(".csv"))
    throw InputError("--out", fmt::format("'{}'", options.out),
                     "the name must end in .csv or .npy");
  std::future<Device> loading = Device::choose_beside(options.device);
  const Catalog catalog = load_catalog();
  const Sampler sampler = catalog.sampler(options.sampler, "--sampler");
  const auto sizes = parse_sizes(options.n, "--n");
  if (sizes.size() != 1)
    throw InputError("--n", fmt::format("'{}'", options.n), "give one number of points");
  check(options, sampler, sizes[0]);
  check_writable(options.out);
  Device device = loading.get();
  const std::string asked =
      options.precision.empty() ? (device.facts().fp64 ? "fp64" : "fp32") : options.precision;
  const Precision precision = asked == "fp64" ? Precision::fp64 : Precision::fp32;
  const std::uint64_t end = end_of(options, sampler, sizes[0]);
  const Plan plan =
      make_points_plan(catalog, sampler.name, options.dim, precision, end, options.replicate + 1,
                       options.seed, device.facts(), options.directions);
  PointsDump dump(device, plan);

  // Under a temporary name until it is complete: a file of that name is not lost to a failure.
  const std::string temporary = options.out + ".new";
  std::ofstream file(temporary, std::ios::binary | std::ios::trunc);
  if (npy) write_npy_header(file, end - options.start, options.dim, plan.fp64());
  const std::uint64_t chunk = std::max<std::uint64_t>(kValuesAtOnce / options.dim, 256);
  for (std::uint64_t start = options.start; start < end; start += chunk) {
    const std::vector<double> values =
        dump.read(start, std::min(chunk, end - start), end, options.replicate);
    if (npy)
      write_npy(file, values, plan.fp64());
    else
      write_csv(file, values, options.dim);
  }
  file.close();
  std::error_code error;
  if (file) std::filesystem::rename(temporary, options.out, error);
  if (!file || error) {
    std::filesystem::remove(temporary, error);
    throw InputError(options.out, "cannot write: the disk takes no more", "free some space");
  }
  return kAllOk;
}

}  // namespace

void add_points(CLI::App& app, Action& action) {
  auto options = std::make_shared<PointsOptions>();
  CLI::App* verb = app.add_subcommand("points", "Write the coordinates of points as .csv or .npy");
  verb->add_option("--sampler", options->sampler,
                   "NAME or NAME:key=value (see koksma list samplers)")
      ->required();
  verb->add_option("--dim", options->dim, "dimensions")->required();
  verb->add_option("--n", options->n,
                   "number of points: 1000 or 2^10; of a set that is not extensible, its size")
      ->required();
  verb->add_option("--start", options->start, "index of the first point; default 0")
      ->check(CLI::Range(std::uint64_t{0}, kLargestSeed));
  verb->add_option("--seed", options->seed, "seed of the randomization; default 1")
      ->check(CLI::Range(std::uint64_t{0}, kLargestSeed));
  verb->add_option("--replicate", options->replicate, "which randomization; default 0")
      ->check(CLI::Range(0, 65535));
  verb->add_option("--precision", options->precision,
                   "fp32 or fp64; default: fp64 where the device has it")
      ->check(CLI::IsMember({"fp32", "fp64"}));
  verb->add_option("--device", options->device, "P:D or part of a name");
  verb->add_option("--directions", options->directions,
                   "Sobol' direction numbers in Joe and Kuo's format");
  verb->add_option("--out", options->out, "F.csv or F.npy")->required();
  verb->callback([options, &action] { action = [options] { return points(*options); }; });
}

}  // namespace koksma
