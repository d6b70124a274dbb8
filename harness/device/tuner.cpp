#include "device/tuner.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <utility>

#include "catalog/embedded.hpp"
#include "catalog/utc.hpp"
#include "device/arguments.hpp"
#include "device/exact.hpp"
#include "device/integrator.hpp"
#include "error/error.hpp"

namespace koksma {
namespace {

constexpr const char* kWorkPath = "harness/device/tune.json";
// Turns of every shape: as many as begin within this time, in these bounds.
constexpr int kLeastTurns = 9, kMostTurns = 25;
constexpr double kSeconds = 2;
// PoCL builds a kernel anew for a launch with a grid as wide as this; such shapes would build in
// the middle of a run.
constexpr std::uint64_t kWidestGrid = std::uint64_t{1} << 16;

using Clock = std::chrono::steady_clock;

// One kernel under one shape, ready to run.
class Contender {
 public:
  Contender(Device& device, const Catalog& catalog, const Cell& cell, const LaunchShape& shape,
            const std::vector<double>& coefficients)
      : plan_(make_plan(catalog, cell, device.facts(), "", {shape})),
        integrator_(device, plan_, coefficients) {
    integrator_.first_values();  // some implementations finish compiling at the first launch
  }
  // integrator_ refers to plan_.
  Contender(const Contender&) = delete;
  Contender& operator=(const Contender&) = delete;

  void take_turn() {
    const double seconds = integrator_.run(
        plan_.cell.n.back(), 0, [](std::uint32_t, std::uint32_t, std::span<const double>) {});
    best_ = best_ > 0 ? std::min(best_, seconds) : seconds;
  }
  double best() const { return best_; }
  const LaunchShape& shape() const { return plan_.shape; }

 private:
  Plan plan_;
  Integrator integrator_;
  double best_ = 0;
};

class KernelTuner {
 public:
  KernelTuner(Device& device, const Catalog& catalog, Cell cell, const TuningWork& work)
      : device_(device), catalog_(catalog), cell_(std::move(cell)), work_(work) {
    const Plan plan = make_plan(catalog, cell_, device.facts());
    family_ = plan.sampler->family;
    usual_ = plan.shape;
    usual_.items_per_launch = kItemsPerLaunch;
    Device exact_device = Device::choose_exact(device);
    coefficients_ = compute_exact(exact_device, *plan.integrand, cell_.scene).coefficients;
  }

  std::vector<TimedShape> run() {
    std::vector<LaunchShape> shapes{usual_};
    vary(shapes, usual_, work_.lanes_per_item, &LaunchShape::lanes_per_item);
    time(shapes);
    shapes.clear();
    vary(shapes, best(), work_.local_sizes, &LaunchShape::local_size);
    time(shapes);
    shapes.clear();
    vary(shapes, best(), work_.items_per_launch, &LaunchShape::items_per_launch);
    time(shapes);
    return timed_;
  }

 private:
  template <typename Values, typename Member>
  static void vary(std::vector<LaunchShape>& shapes, LaunchShape shape, const Values& values,
                   Member member) {
    for (const auto value : values) {
      shape.*member = value;
      shapes.push_back(shape);
    }
  }

  const TimedShape* find(const LaunchShape& shape) const {
    const auto found = std::find_if(timed_.begin(), timed_.end(), [&](const TimedShape& t) {
      return same_shape(t.shape, shape);
    });
    return found == timed_.end() ? nullptr : &*found;
  }

  bool is_wanted(const LaunchShape& shape) const {
    const std::uint64_t groups = kLanes / shape.lanes_per_item;
    return find(shape) == nullptr && shape.local_size <= device_.facts().max_work_group_size &&
           (!device_.facts().is_cpu || *shape.items_per_launch * groups < kWidestGrid);
  }

  LaunchShape best() const {
    if (timed_.empty()) return usual_;
    return std::min_element(
               timed_.begin(), timed_.end(),
               [](const TimedShape& a, const TimedShape& b) { return a.seconds < b.seconds; })
        ->shape;
  }

  // The best so far runs again beside the new ones: a machine that has slowed down meanwhile would
  // make it look better than they are.
  void time(const std::vector<LaunchShape>& shapes) {
    std::vector<std::unique_ptr<Contender>> contenders;
    for (const LaunchShape& shape : shapes) {
      const auto same = [&](const auto& c) { return same_shape(c->shape(), shape); };
      if (!is_wanted(shape) || std::any_of(contenders.begin(), contenders.end(), same)) continue;
      add(contenders, shape);
    }
    if (contenders.empty()) return;
    if (!timed_.empty()) add(contenders, best());
    const auto start = Clock::now();
    for (int turn = 0; turn < kMostTurns; ++turn) {
      for (auto& contender : contenders) contender->take_turn();
      const double spent = std::chrono::duration<double>(Clock::now() - start).count();
      if (turn + 1 >= kLeastTurns && spent > kSeconds) break;
    }
    take_over(contenders);
  }

  // Seconds of a later phase are scaled by what the shape that ran in both took.
  void take_over(const std::vector<std::unique_ptr<Contender>>& contenders) {
    const TimedShape* again = find(contenders.back()->shape());
    const double scale = again == nullptr ? 1 : again->seconds / contenders.back()->best();
    for (const auto& contender : contenders)
      if (find(contender->shape()) == nullptr)
        timed_.push_back(
            {family_, *cell_.precision, contender->shape(), contender->best() * scale});
  }

  void add(std::vector<std::unique_ptr<Contender>>& contenders, const LaunchShape& shape) {
    // More registers or private memory than there are, perhaps; but the default shape must run.
    const bool may_fail = !timed_.empty() || !contenders.empty();
    try {
      auto contender = std::make_unique<Contender>(device_, catalog_, cell_, shape, coefficients_);
      contender->take_turn();
      contenders.push_back(std::move(contender));
    } catch (const DeviceError&) {
      if (!may_fail) throw;
    } catch (const BuildError&) {
      if (!may_fail) throw;
    }
  }

  Device& device_;
  const Catalog& catalog_;
  Cell cell_;
  const TuningWork& work_;
  std::string family_;
  LaunchShape usual_;
  std::vector<double> coefficients_;
  std::vector<TimedShape> timed_;
};

Cell cell_of(const Catalog& catalog, const TuningWork& work, const TuningWork::Kernel& kernel,
             Precision precision) {
  Cell cell;
  cell.scene = parse_scene(catalog, kernel.scene, kWorkPath);
  cell.sampler = kernel.sampler;
  cell.estimator = catalog.sampler(kernel.sampler, kWorkPath).default_estimator;
  cell.precision = precision;
  cell.n = {work.n};
  cell.replicates = work.replicates;
  cell.seed = 1;
  return cell;
}

}  // namespace

TuningWork tuning_work(const DeviceFacts& device) {
  const Json json = parse_json(embedded_text(kWorkPath), kWorkPath);
  TuningWork work;
  for (const Json& cell : json["cells"]) work.kernels.push_back({cell["scene"], cell["sampler"]});
  work.n = json["n"];
  work.replicates = json["replicates"];
  work.lanes_per_item = json["lanes_per_item"].get<std::vector<std::uint32_t>>();
  work.local_sizes =
      json["local_size"][device.is_cpu ? "cpu" : "other"].get<std::vector<std::uint32_t>>();
  work.items_per_launch = json["items_per_launch"].get<std::vector<std::uint64_t>>();
  return work;
}

Tuning tune(Device& device, const Catalog& catalog, const TuningWork& work,
            const std::function<void(const std::string&)>& note) {
  device.forget_tuning();
  Tuning tuning;
  tuning.date = utc_now();
  for (const Precision precision : {Precision::fp32, Precision::fp64}) {
    if (precision == Precision::fp64 && !device.facts().fp64) continue;
    for (const TuningWork::Kernel& kernel : work.kernels) {
      if (note) note(fmt::format("{} {}", precision_name(precision), kernel.sampler));
      KernelTuner tuner(device, catalog, cell_of(catalog, work, kernel, precision), work);
      const std::vector<TimedShape> timed = tuner.run();
      tuning.timed.insert(tuning.timed.end(), timed.begin(), timed.end());
    }
  }
  return tuning;
}

}  // namespace koksma
