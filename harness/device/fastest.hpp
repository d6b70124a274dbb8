// The fastest of many rounds of one subject: what a machine that others disturb can do.
#pragma once

#include <algorithm>
#include <vector>

namespace koksma {

class Fastest {
 public:
  void add(double seconds) {
    seconds_.push_back(seconds);
    std::sort(seconds_.begin(), seconds_.end());
    seconds_.resize(std::min<std::size_t>(seconds_.size(), 3));
  }
  // After one round at least.
  double best() const { return seconds_.front(); }
  // Three rounds within 2 %: not one lucky reading, and not a machine that was busy throughout.
  bool settled() const {
    return seconds_.size() == 3 && seconds_.back() <= 1.02 * seconds_.front();
  }

 private:
  std::vector<double> seconds_;
};

}  // namespace koksma
