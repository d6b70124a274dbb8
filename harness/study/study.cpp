#include "study/study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <map>
#include <set>

#include "catalog/embedded.hpp"
#include "catalog/sizes.hpp"
#include "error/error.hpp"

namespace koksma {
namespace {

constexpr std::string_view kDefaultStudy = "harness/study/studies/default.json";
constexpr std::string_view kSizesHelp =
    "write 2^8..2^20, 2^10, 1000, or a comma-separated list of these";

std::uint64_t parse_size(std::string_view text, std::string_view whole, std::string_view where) {
  const bool power = text.starts_with("2^");
  const std::string_view digits = power ? text.substr(2) : text;
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  const bool whole_number = error == std::errc{} && end == digits.data() + digits.size();
  if (!whole_number || (power ? value > 62 : value == 0))
    throw InputError(where, fmt::format("'{}' in '{}' is no sample count", text, whole),
                     kSizesHelp);
  return power ? std::uint64_t{1} << value : value;
}

void add_range(std::set<std::uint64_t>& sizes, std::string_view item, std::string_view whole,
               std::string_view where) {
  const std::size_t dots = item.find("..");
  const std::uint64_t first = parse_size(item.substr(0, dots), whole, where);
  if (dots == std::string_view::npos) {
    sizes.insert(first);
    return;
  }
  const std::uint64_t last = parse_size(item.substr(dots + 2), whole, where);
  if (!std::has_single_bit(first) || !std::has_single_bit(last) || first > last)
    throw InputError(where, fmt::format("'{}' is no range", item),
                     "a range runs between two powers of two, upwards");
  for (std::uint64_t n = first; n <= last; n *= 2) sizes.insert(n);
}

// The number that the block or the study gives, unless the flag does.
template <typename Number>
std::optional<Number> number_setting(const std::optional<Number>& flag, const Json& block,
                                     const Json& study, const char* key) {
  if (flag) return flag;
  for (const Json* level : {&block, &study})
    if (level->contains(key)) return level->at(key).get<Number>();
  return std::nullopt;
}

// The value of the innermost place that sets `key`: the flag, the block, the study.
std::string setting(const std::string& flag, const Json& block, const Json& study,
                    const char* key) {
  if (!flag.empty()) return flag;
  for (const Json* level : {&block, &study})
    if (const auto found = level->find(key); found != level->end())
      return found->get<std::string>();
  return "";
}

std::string where_set(const std::string& flag, const char* key, const Json& block,
                      const std::string& file, const std::string& pointer) {
  if (!flag.empty()) return fmt::format("--{}", key);
  return fmt::format("{}, at '{}/{}'", file, block.contains(key) ? pointer : "", key);
}

void check_sizes(const Cell& cell, const Sampler& sampler, const std::string& where) {
  for (const std::uint64_t n : cell.n) {
    if (n > std::uint64_t{1} << sampler.max_log2_n)
      throw InputError(where, fmt::format("N = {} for sampler '{}'", n, sampler.name),
                       fmt::format("it has at most 2^{} points", sampler.max_log2_n));
    check_size(sampler, cell.scene.dim, n, where);
  }
}

struct BlockReader {
  const Catalog& catalog;
  const StudyFlags& flags;
  const Json& study;
  const Json& block;
  std::string file, pointer;

  std::string place(const std::string& flag, const char* key) const {
    return where_set(flag, key, block, file, pointer);
  }

  Cell cell(const Scene& scene, const std::string& sampler_name,
            const std::string& sampler_where) const {
    const Sampler sampler = catalog.sampler(sampler_name, sampler_where);
    if (scene.dim < sampler.min_dim)
      throw InputError(
          sampler_where, fmt::format("scene '{}' draws d = {}", scene.text, scene.dim),
          fmt::format("sampler '{}' has at least {} dimensions", sampler.name, sampler.min_dim));
    if (scene.dim > sampler.max_dim && !(flags.own_directions && sampler.reads_directions))
      throw InputError(
          sampler_where, fmt::format("scene '{}' draws d = {}", scene.text, scene.dim),
          fmt::format("sampler '{}' has at most {} dimensions", sampler.name, sampler.max_dim));
    Cell cell;
    cell.scene = scene;
    cell.sampler = sampler.name;
    set_estimator(cell, sampler);
    const std::string precision = setting(flags.precision, block, study, "precision");
    if (!precision.empty())
      cell.precision = precision == "fp32" ? Precision::fp32 : Precision::fp64;
    cell.sum = setting(flags.sum, block, study, "sum");
    if (!cell.sum.empty()) catalog.sum(cell.sum, place(flags.sum, "sum"));
    const std::string sizes = setting(flags.n, block, study, "n");
    const std::string sizes_where = place(flags.n, "n");
    cell.n = parse_sizes(sizes.empty() ? "2^8..2^18" : sizes, sizes_where);
    check_sizes(cell, sampler, sizes_where);
    cell.launches = number_setting(flags.launches, block, study, "launches");
    set_stop(cell);
    return cell;
  }

  void set_stop(Cell& cell) const {
    cell.stop.time_budget = number_setting(flags.time_budget, block, study, "time_budget");
    cell.stop.until = number_setting(flags.until, block, study, "until");
    const std::string beyond = setting("", block, study, "beyond_n");
    if (beyond.empty()) return;
    const std::string where = place("", "beyond_n");
    if (!cell.stop.any())
      throw InputError(where, fmt::format("'{}', and nothing that ends the curve", beyond),
                       "beyond_n goes with time_budget or until");
    const std::vector<std::uint64_t> sizes = parse_sizes(beyond, where);
    if (sizes.size() != 1)
      throw InputError(where, fmt::format("'{}' is no single sample count", beyond),
                       "write 2^26 or 1000000");
    if (sizes.front() < cell.n.back())
      throw InputError(where, fmt::format("'{}' is below the largest N, {}", beyond, cell.n.back()),
                       "it is how far beyond it the curve may go");
    cell.stop.beyond_n = sizes.front();
  }

  void set_estimator(Cell& cell, const Sampler& sampler) const {
    const std::string name = setting(flags.estimator, block, study, "estimator");
    const std::string where = place(flags.estimator, "estimator");
    const Estimator& estimator =
        catalog.estimator(name.empty() ? sampler.default_estimator : name, where);
    if (!fits(estimator, sampler))
      throw InputError(
          where,
          fmt::format("estimator '{}' does not fit sampler '{}'", estimator.name, sampler.name),
          fmt::format("{}{}these do: {}", estimator.note, estimator.note.empty() ? "" : "; ",
                      fmt::join(fitting_estimators(catalog, sampler), ", ")));
    cell.estimator = estimator.name;
    const std::uint32_t fallback =
        block.value("replicates", study.value("replicates", std::uint32_t{32}));
    cell.replicates = estimator.replicated ? flags.replicates.value_or(fallback) : 1;
    if (estimator.interval == "student-t" && cell.replicates < 2)
      throw InputError(
          flags.replicates ? "--replicates" : place("", "replicates"), "1 replicate",
          fmt::format("estimator '{}' needs at least 2 for its interval", estimator.name));
  }
};

// Flags replace the lists of the study; what remains is an ordinary study, so both go one way.
Json merged(const Json& study, const StudyFlags& flags) {
  Json result = study;
  if (!flags.scenes.empty() || !flags.samplers.empty()) {
    Json block = study["cells"][0];
    if (!flags.scenes.empty()) block["scenes"] = flags.scenes;
    if (!flags.samplers.empty()) block["samplers"] = flags.samplers;
    result["cells"] = Json::array();
    if (flags.scenes.empty() || flags.samplers.empty()) {
      for (Json each : study["cells"]) {
        if (!flags.scenes.empty()) each["scenes"] = flags.scenes;
        if (!flags.samplers.empty()) each["samplers"] = flags.samplers;
        if (std::find(result["cells"].begin(), result["cells"].end(), each) ==
            result["cells"].end())
          result["cells"].push_back(each);
      }
    } else {
      result["cells"].push_back(block);
    }
  }
  for (const auto& [key, value] :
       {std::pair{"n", flags.n}, {"precision", flags.precision}, {"sum", flags.sum}}) {
    if (value.empty()) continue;
    result[key] = value;
    for (Json& block : result["cells"]) block.erase(key);
  }
  for (const auto& [key, value] :
       {std::pair{"time_budget", flags.time_budget}, {"until", flags.until}}) {
    if (!value) continue;
    result[key] = *value;
    for (Json& block : result["cells"]) block.erase(key);
  }
  if (!flags.estimator.empty())
    for (Json& block : result["cells"]) block["estimator"] = flags.estimator;
  if (flags.seed) result["seed"] = *flags.seed;
  for (const auto& [key, value] :
       {std::pair{"replicates", flags.replicates}, {"launches", flags.launches}}) {
    if (!value) continue;
    result[key] = *value;
    for (Json& block : result["cells"]) block.erase(key);
  }
  return result;
}

}  // namespace

std::string_view precision_name(Precision precision) {
  return precision == Precision::fp32 ? "fp32" : "fp64";
}

void check_size(const Sampler& sampler, std::uint32_t dim, std::uint64_t n,
                const std::string& where) {
  if (admits(sampler, dim, n)) return;
  static const std::map<std::string, std::string> forms{{"even", "an even number"},
                                                        {"power-of-two", "a power of two"},
                                                        {"power-of-d", "m^d"},
                                                        {"twice-power-of-d", "2 m^d"},
                                                        {"rectangle", "a b with a <= b <= 2 a"}};
  const NearestSizes nearest = nearest_sizes(sampler, dim, n);
  std::vector<std::uint64_t> sizes;
  for (const auto& size : {nearest.below, nearest.above})
    if (size) sizes.push_back(*size);
  throw InputError(
      where, fmt::format("N = {} for sampler '{}'", n, sampler.name),
      fmt::format("it needs {}{}; the nearest {} {}", forms.at(sampler.size_form),
                  sampler.size_form.ends_with("power-of-d") ? fmt::format(", d = {}", dim) : "",
                  sizes.size() == 1 ? "is" : "are", fmt::join(sizes, " and ")));
}

std::vector<std::uint64_t> parse_sizes(std::string_view text, std::string_view where) {
  std::set<std::uint64_t> sizes;
  std::string_view rest = text;
  while (true) {
    const std::size_t comma = rest.find(',');
    add_range(sizes, rest.substr(0, comma), text, where);
    if (comma == std::string_view::npos) break;
    rest = rest.substr(comma + 1);
  }
  return {sizes.begin(), sizes.end()};
}

std::uint64_t largest_size(const Sampler& sampler, const Cell& cell) {
  const std::uint64_t asked = cell.n.back();
  const std::uint64_t most = std::uint64_t{1} << sampler.max_log2_n;
  if (!cell.stop.any() || most <= asked) return asked;
  if (cell.stop.beyond_n) return std::min(*cell.stop.beyond_n, most);
  if (cell.stop.time_budget) return most;
  return asked > most / kBeyondStudy ? most : asked * kBeyondStudy;
}

std::optional<std::uint64_t> next_size(const Sampler& sampler, const Cell& cell, std::uint64_t n) {
  const auto asked = std::upper_bound(cell.n.begin(), cell.n.end(), n);
  if (asked != cell.n.end()) return *asked;
  const std::uint64_t largest = largest_size(sampler, cell);
  if (n > largest / 2) return std::nullopt;
  const std::optional<std::uint64_t> next = nearest_sizes(sampler, cell.scene.dim, 2 * n).above;
  return next && *next <= largest ? next : std::nullopt;
}

Study read_study(const Catalog& catalog, const std::string& path, const StudyFlags& flags) {
  const std::string file = path.empty() ? std::string(kDefaultStudy) : path;
  const std::string text =
      path.empty() ? std::string(embedded_text(kDefaultStudy)) : read_text_file(path);
  return study_from(catalog, parse_json(text, file), file, flags);
}

Study study_from(const Catalog& catalog, const Json& given, const std::string& file,
                 const StudyFlags& flags) {
  check_schema(given, "harness/study/study.schema.json", file);

  Study study;
  study.verbatim = merged(given, flags);
  study.title = study.verbatim.value("title", "");
  study.seed = study.verbatim.value("seed", std::uint64_t{1});
  const Json& blocks = study.verbatim["cells"];
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const BlockReader reader{catalog,   flags, study.verbatim,
                             blocks[b], file,  fmt::format("/cells/{}", b)};
    for (std::size_t s = 0; s < blocks[b]["scenes"].size(); ++s) {
      const std::string where = flags.scenes.empty()
                                    ? fmt::format("{}, at '{}/scenes/{}'", file, reader.pointer, s)
                                    : "--scene";
      const Scene scene = parse_scene(catalog, blocks[b]["scenes"][s].get<std::string>(), where);
      for (std::size_t p = 0; p < blocks[b]["samplers"].size(); ++p) {
        const std::string sampler_where =
            flags.samplers.empty() ? fmt::format("{}, at '{}/samplers/{}'", file, reader.pointer, p)
                                   : "--sampler";
        Cell cell = reader.cell(scene, blocks[b]["samplers"][p], sampler_where);
        cell.seed = study.seed;
        study.cells.push_back(std::move(cell));
      }
    }
  }
  return study;
}

}  // namespace koksma
