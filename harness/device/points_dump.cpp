#include "device/points_dump.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

#include "catalog/lanes.hpp"
#include "device/prepare.hpp"

namespace koksma {
namespace {}  // namespace

PointsDump::PointsDump(Device& device, const Plan& plan) : device_(device), plan_(plan) {
  const BuiltProgram built = device.build(plan.program);
  kernel_ = checked([&] { return cl::Kernel(built.program, "dump_points"); });
  const std::vector<std::byte> table = point_table(device, plan);
  table_ = device.upload(table.data(), table.size());
}

std::vector<double> PointsDump::read(std::uint64_t start, std::uint64_t count, std::uint64_t n,
                                     std::uint32_t replicate, std::uint32_t log2_block) {
  // Blocks no longer than the set: tables reach as far as its indices do.
  log2_block =
      std::min(log2_block, std::max(static_cast<std::uint32_t>(std::bit_width(n - 1)), 4U));
  const std::uint64_t dim = plan_.request.dim;
  const std::uint64_t first_block = start >> log2_block;
  const std::uint64_t blocks = ((start + count - 1) >> log2_block) - first_block + 1;
  const std::uint64_t values = (blocks << log2_block) * dim;
  const std::size_t size = plan_.fp64() ? 8 : 4;
  std::vector<std::byte> raw(values * size);
  checked([&] {
    const cl::Buffer out = device_.allocate(raw.size());
    cl_uint arg = 0;
    kernel_.setArg(arg++, table_);
    for (const std::uint64_t value : {first_block, blocks, n, plan_.request.seed})
      kernel_.setArg(arg++, cl_ulong{value});
    kernel_.setArg(arg++, cl_uint{log2_block});
    kernel_.setArg(arg++, cl_uint{replicate});
    kernel_.setArg(arg++, out);
    const std::uint64_t items = blocks * (kLanes / plan_.shape.lanes_per_item);
    const std::uint64_t local = plan_.shape.local_size;
    device_.queue().enqueueNDRangeKernel(kernel_, cl::NullRange,
                                         cl::NDRange((items + local - 1) / local * local),
                                         cl::NDRange(local));
    device_.queue().enqueueReadBuffer(out, CL_TRUE, 0, raw.size(), raw.data());
  });

  // The device writes [step][dimension][lane]; here the lanes become consecutive points.
  std::vector<double> points(count * dim);
  const std::uint64_t offset = start - (first_block << log2_block);
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::uint64_t step = (offset + i) / kLanes, lane = (offset + i) % kLanes;
    for (std::uint64_t d = 0; d < dim; ++d) {
      const std::byte* source = raw.data() + ((step * dim + d) * kLanes + lane) * size;
      if (plan_.fp64()) {
        std::memcpy(&points[i * dim + d], source, size);
      } else {
        float narrow = 0;
        std::memcpy(&narrow, source, size);
        points[i * dim + d] = narrow;
      }
    }
  }
  return points;
}

}  // namespace koksma
