// Peer: QMCToolsCL's C path. qmctoolscl LIBRARY MATRICES
// LIBRARY is the shared object of its Python package, MATRICES a text file with the generating matrices
// of Sobol's sequence, 32 columns of 32 bits a dimension. Digitally shifted points in Gray-code order.
#include <dlfcn.h>

#include <fstream>
#include <random>

#include "worker.hpp"

namespace {

using Word = unsigned long long;
constexpr Word kColumns = 32;
// dnb2_gen_gray_float: replications, points, dimensions; the batch sizes of these; start, columns,
// replications of the matrices; whether to shift; left shifts, shifts, bits; matrices; points.
using Generate = void (*)(Word, Word, Word, Word, Word, Word, Word, Word, Word, unsigned char, Word*, Word*, Word*,
                          Word*, double*);

Generate load(const char* library) {
  void* handle = dlopen(library, RTLD_LAZY | RTLD_GLOBAL);
  if (handle == nullptr) throw std::runtime_error(dlerror());
  void* symbol = dlsym(handle, "dnb2_gen_gray_float");
  if (symbol == nullptr) throw std::runtime_error("no dnb2_gen_gray_float in the library");
  return reinterpret_cast<Generate>(symbol);
}

}  // namespace

int main(int, char** argv) {
  const Generate generate = load(argv[1]);
  std::vector<Word> matrices(peer::kDim * kColumns);
  std::ifstream in(argv[2]);
  for (Word& column : matrices)
    if (!(in >> column)) throw std::runtime_error("the file of matrices is too short");
  return peer::serve([&](const peer::Job& job, unsigned replicate) {
    std::mt19937_64 random(job.seed * 65536 + replicate);
    Word left = 0, bits = 32, shifts[peer::kDim];
    for (Word& shift : shifts) shift = random() >> 32;
    return peer::blockwise_mean<double>(job, [&](double* x, std::uint64_t start, std::size_t count) {
      generate(1, count, peer::kDim, 1, count, peer::kDim, start, kColumns, 1, 1, &left, shifts, &bits,
               matrices.data(), x);
    });
  });
}
