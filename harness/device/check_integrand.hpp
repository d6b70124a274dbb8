// Checks on an integrand that the project's own tests have not seen: a user's.
#pragma once

#include "device/device.hpp"
#include "device/exact.hpp"

namespace koksma {

// InputError, naming the entry's file, when the kernel draws another number of coordinates than the
// scene has, or when a formula for the mean contradicts one of the entry's own checks by more than
// 1e-9.
void check_user_integrand(const Catalog& catalog, Device& device, Device& exact_device,
                          const Cell& cell);

}  // namespace koksma
