"""Peers that are OpenCL kernels, as a process that answers jobs (cpp/worker.hpp has the protocol).

    opencl_worker.py point|strided|qmctoolscl fp32|fp64 MATRICES [DEVICE]

point, strided: the kernels of scalar.cl. qmctoolscl: the package's own kernel writes the points to the
device's memory, and scalar.cl's `evaluate` reads them there; nothing but partial sums is copied to the host.
MATRICES: as for cpp/qmctoolscl.cpp. DEVICE: part of a platform's name; PoCL unless said, as for koksma.
"""
import os
import sys
import time
import warnings

import numpy
import pyopencl

import problem as problems

KINDS = {"linear-prod": 0, "genz-gaussian": 1, "genz-oscillatory": 2}
GROUP = 128  # work-items
LOG2_STRIDE = 12  # work-items of `strided`
BLOCK = 2 ** 16  # points of QMCToolsCL at a time: 4 MiB


def choose(text):
    platforms = [p for p in pyopencl.get_platforms() if text.lower() in (p.name + p.vendor).lower()]
    if not platforms:
        raise SystemExit(f"no OpenCL platform is called '{text}'")
    return platforms[0].get_devices()[0]


class Device:
    def __init__(self, precision, matrices, name):
        self.real = {"fp32": numpy.float32, "fp64": numpy.float64}[precision]
        self.matrices = numpy.loadtxt(matrices, dtype=numpy.uint64)[:problems.DIM]
        device = choose(name)
        self.context = pyopencl.Context([device])
        self.queue = pyopencl.CommandQueue(self.context)
        self.programs = {}

    def upload(self, array):
        flags = pyopencl.mem_flags.READ_ONLY | pyopencl.mem_flags.COPY_HOST_PTR
        return pyopencl.Buffer(self.context, flags, hostbuf=numpy.ascontiguousarray(array))

    def allocate(self, count, size):
        return pyopencl.Buffer(self.context, pyopencl.mem_flags.READ_WRITE, count * size)

    def kernel(self, name, problem):
        """Built once a kernel and integrand, so that a warm job builds nothing."""
        key = name, problem.name
        if key not in self.programs:
            path = os.path.join(os.path.dirname(os.path.abspath(__file__)), "scalar.cl")
            real = "float" if self.real is numpy.float32 else "double"
            options = ["-cl-std=CL1.2", f"-DREAL={real}", f"-DDIM={problems.DIM}", f"-DKIND={KINDS[problem.name]}"]
            with open(path, encoding="ascii") as source:
                program = pyopencl.Program(self.context, source.read()).build(options)
            self.programs[key] = pyopencl.Kernel(program, name)
        return self.programs[key]


def partial_sum(device, kernel, count, arguments):
    group = min(GROUP, count)
    partial = device.allocate(count // group, 8)
    kernel(device.queue, (count,), (group,), *arguments, pyopencl.LocalMemory(8 * group), partial)
    sums = numpy.empty(count // group)
    pyopencl.enqueue_copy(device.queue, sums, partial)
    return sums.sum()


def sobol(device, kernel, problem, n, shifts):
    columns = device.upload(device.matrices.astype(numpy.uint32))
    shifts = device.upload(shifts.astype(numpy.uint32))
    coefficients = device.upload(numpy.array(problem.coefficients, device.real))
    log2_stride = min(LOG2_STRIDE, n.bit_length() - 1)
    items = n if kernel == "point" else 2 ** log2_stride
    sizes = numpy.uint32(n), numpy.uint32(log2_stride)
    arguments = *sizes, columns, shifts, coefficients, device.real(problem.constant)
    return partial_sum(device, device.kernel(kernel, problem), items, arguments) / n


def qmctoolscl_points(device, _, problem, n, shifts):
    import qmctoolscl
    from qmctoolscl.util import get_qmctoolscl_program_from_context
    name = "dnb2_gen_gray_float"
    if name not in device.programs:
        device.programs[name] = get_qmctoolscl_program_from_context(device.context, name, ())
    block = min(BLOCK, n)
    points = device.allocate(block * problems.DIM, 8)
    tables = [device.upload(numpy.array(t, numpy.uint64)) for t in ([0], shifts, [32], device.matrices)]
    coefficients = device.upload(numpy.array(problem.coefficients))
    kernel, one, dim = device.kernel("evaluate", problem), numpy.uint64(1), numpy.uint64(problems.DIM)
    total = 0.0
    for start in range(0, n, block):
        qmctoolscl.dnb2_gen_gray_float(
            one, numpy.uint64(block), dim, numpy.uint64(start), numpy.uint64(32), one, numpy.uint8(1), *tables, points,
            backend="cl", context=device.context, queue=device.queue, program=device.programs[name],
            global_size=(1, 64, 1), local_size=None)
        total += partial_sum(device, kernel, block, (points, coefficients, numpy.float64(problem.constant)))
    return total / n


def main():
    method, precision, matrices, *name = sys.argv[1:]
    device = Device(precision, matrices, name[0] if name else "portable")
    mean = qmctoolscl_points if method == "qmctoolscl" else sobol
    warnings.simplefilter("ignore")  # the package looks its kernel up at every call
    for line in sys.stdin:
        problem, n, replicates, seed = problems.parse_job(line)
        random = numpy.random.default_rng(seed)
        start = time.perf_counter()
        estimates = []
        for _ in range(replicates):
            shifts = random.integers(0, 2 ** 32, problems.DIM, dtype=numpy.uint64)
            estimates.append(float(mean(device, method, problem, n, shifts)))
        print(time.perf_counter() - start, *map(repr, estimates), flush=True)


if __name__ == "__main__":
    main()
