// Peer: Boost.Random's Sobol' engine with 32-bit words, in Gray-code order.
#include <boost/random/sobol.hpp>

#include "worker.hpp"

int main() {
  using Engine = boost::random::sobol_engine<boost::uint32_t, 32>;
  return peer::serve([](const peer::Job& job, unsigned) {
    Engine engine(peer::kDim);
    return peer::blockwise_mean<double>(job, [&](double* x, std::uint64_t, std::size_t count) {
      for (std::size_t k = 0; k < count * peer::kDim; ++k) x[k] = engine() * 0x1p-32;
    });
  });
}
