// The fastest of many rounds of one subject.
#pragma once

#include "device/fastest.hpp"

namespace koksma::bench {

using koksma::Fastest;

}  // namespace koksma::bench
