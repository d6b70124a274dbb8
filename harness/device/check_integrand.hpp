// Checks on an integrand that the project's own tests have not seen: a user's.
#pragma once

#include "device/device.hpp"
#include "device/exact.hpp"

namespace koksma {

// InputError, naming the entry's file, when the code does not compile, the kernel draws another
// number of coordinates than the scene has, a formula gives no finite mean at the scene's
// parameters, or the formula or constant of the mean or the variance contradicts one of the entry's
// own checks by more than 1e-9, or the entry's tolerance where that is larger. Entries of the
// project may give no number outside their domain, which is theirs to say: there the integral
// counts as unknown.
void check_user_integrand(const Catalog& catalog, Device& device, Device& exact_device,
                          const Cell& cell);

}  // namespace koksma
