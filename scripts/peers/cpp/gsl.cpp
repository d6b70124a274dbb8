// Peer: the GNU Scientific Library. gsl sobol|plain|vegas
// Its Sobol' generator (gsl_qrng_sobol, which begins with the point after 0), gsl_monte_plain and
// gsl_monte_vegas with its default parameters, which spends N samples over 5 iterations.
#include <gsl/gsl_errno.h>
#include <gsl/gsl_monte_plain.h>
#include <gsl/gsl_monte_vegas.h>
#include <gsl/gsl_qrng.h>
#include <gsl/gsl_rng.h>

#include "worker.hpp"

namespace {

struct Problem {
  const peer::Job* job;
  peer::Sum<double> value;
};

double value_at(double* x, std::size_t, void* problem) {
  const Problem& p = *static_cast<const Problem*>(problem);
  return p.value(*p.job, x, 1);
}

double sobol(const peer::Job& job, unsigned) {
  gsl_qrng* q = gsl_qrng_alloc(gsl_qrng_sobol, peer::kDim);
  const double mean = peer::blockwise_mean<double>(job, [&](double* x, std::uint64_t, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) gsl_qrng_get(q, x + i * peer::kDim);
  });
  gsl_qrng_free(q);
  return mean;
}

double monte(const peer::Job& job, unsigned replicate, bool vegas) {
  Problem problem{&job, peer::sum_of<double>(job)};
  gsl_monte_function f{value_at, peer::kDim, &problem};
  double low[peer::kDim], high[peer::kDim], mean = 0, error = 0;
  for (std::size_t j = 0; j < peer::kDim; ++j) low[j] = 0, high[j] = 1;
  gsl_rng* random = gsl_rng_alloc(gsl_rng_mt19937);
  gsl_rng_set(random, static_cast<unsigned long>(job.seed * 65536 + replicate + 1));
  if (vegas) {
    gsl_monte_vegas_state* state = gsl_monte_vegas_alloc(peer::kDim);
    gsl_monte_vegas_params parameters;
    gsl_monte_vegas_params_get(state, &parameters);
    gsl_monte_vegas_integrate(&f, low, high, peer::kDim, job.n / parameters.iterations, random, state, &mean, &error);
    gsl_monte_vegas_free(state);
  } else {
    gsl_monte_plain_state* state = gsl_monte_plain_alloc(peer::kDim);
    gsl_monte_plain_integrate(&f, low, high, peer::kDim, job.n, random, state, &mean, &error);
    gsl_monte_plain_free(state);
  }
  gsl_rng_free(random);
  return mean;
}

}  // namespace

int main(int, char** argv) {
  const std::string method = argv[1];
  return peer::serve([&](const peer::Job& job, unsigned replicate) {
    return method == "sobol" ? sobol(job, replicate) : monte(job, replicate, method == "vegas");
  });
}
