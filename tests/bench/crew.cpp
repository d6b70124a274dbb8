#include "crew.hpp"

#include <sched.h>

#include <atomic>
#include <barrier>
#include <chrono>
#include <thread>
#include <vector>

namespace koksma::bench {
namespace {

class Crew {
 public:
  Crew()
      : processors_(allowed_processors()),
        gate_(static_cast<std::ptrdiff_t>(processors_.size()) + 1) {
    for (const int processor : processors_)
      threads_.emplace_back([this, processor] { serve(processor); });
  }
  ~Crew() {
    stop_ = true;
    gate_.arrive_and_wait();
    for (std::thread& thread : threads_) thread.join();
  }
  Crew(const Crew&) = delete;
  Crew& operator=(const Crew&) = delete;

  // Runs `work` once on every thread.
  void run(const std::function<void()>& work) {
    work_ = &work;
    gate_.arrive_and_wait();
    gate_.arrive_and_wait();
  }

 private:
  static std::vector<int> allowed_processors() {
    cpu_set_t allowed;
    CPU_ZERO(&allowed);
    std::vector<int> processors;
    if (sched_getaffinity(0, sizeof allowed, &allowed) == 0)
      for (int i = 0; i < CPU_SETSIZE; ++i)
        if (CPU_ISSET(i, &allowed)) processors.push_back(i);
    return processors;
  }
  void serve(int processor) {
    cpu_set_t own;
    CPU_ZERO(&own);
    CPU_SET(processor, &own);
    sched_setaffinity(0, sizeof own, &own);
    while (true) {
      gate_.arrive_and_wait();
      if (stop_) return;
      (*work_)();
      gate_.arrive_and_wait();
    }
  }

  std::vector<int> processors_;
  std::barrier<> gate_;  // passed at the start and at the end of every run
  const std::function<void()>* work_ = nullptr;
  bool stop_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace

double run_on_crew(std::uint64_t units, const std::function<void(std::uint64_t)>& work) {
  static Crew every_processor;
  std::atomic<std::uint64_t> next{0};
  const auto start = std::chrono::steady_clock::now();
  every_processor.run([&] {
    for (std::uint64_t unit = next++; unit < units; unit = next++) work(unit);
  });
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace koksma::bench
