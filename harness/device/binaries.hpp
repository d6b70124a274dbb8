// Built programs kept between runs, so that a second run spends its time in kernels: loading one
// takes milliseconds where PoCL, with its own cache warm, still preprocesses the source for 50. In
// $XDG_CACHE_HOME/koksma/programs, safe to delete; off with KOKSMA_KEPT=off.
#pragma once

#include <CL/opencl.hpp>  // with the CL_HPP_ definitions of CMakeLists.txt
#include <optional>
#include <string>

#include "plan/plan.hpp"

namespace koksma {

class KeptPrograms {
 public:
  // None: nothing is found and nothing kept.
  KeptPrograms() = default;
  // `folder` need not exist. Programs are told apart by their text and options and by `device`,
  // which names device, driver and everything else that a binary depends on.
  KeptPrograms(std::string folder, std::string device);

  // The program, built and ready, if an earlier run kept it whole (PoCL aborts the process on a
  // binary that is cut short, so the driver sees none whose checksum is wrong) and the driver takes
  // it.
  std::optional<cl::Program> find(const cl::Context& context, const cl::Device& device,
                                  const ProgramSource& source) const;
  // Keeps a program that was built from this source. What can not be kept is built again next time.
  void keep(const cl::Program& program, const ProgramSource& source) const;

  // The file of a program; "" where none are kept.
  std::string file(const ProgramSource& source) const;

 private:
  Json header(const ProgramSource& source) const;

  std::string folder_, device_;
};

}  // namespace koksma
