"""A peer that is a Python package, as a process that answers jobs (cpp/worker.hpp has the protocol).

    python_worker.py scipy-sobol|scipy-halton|qmcpy|vegas

Replicates are shared out between two processes. Points are drawn in blocks of 2^14 where the package can
continue a sequence, evaluated by NumPy.
"""
import multiprocessing
import sys
import time
import warnings

import problem as problems

BLOCK = 2 ** 14


def scipy_engine(name):
    from scipy.stats import qmc
    kind = {"scipy-sobol": qmc.Sobol, "scipy-halton": qmc.Halton}[name]

    def mean(f, n, seed):
        engine = kind(problems.DIM, scramble=True, rng=seed)
        return sum(f(engine.random(min(BLOCK, n))).sum() for _ in range(max(1, n // BLOCK))) / n

    return mean


def qmcpy_net(_):
    import qmcpy

    def mean(f, n, seed):
        net = qmcpy.DigitalNetB2(problems.DIM, seed=seed, randomize="LMS_DS", order="GRAY")
        step = min(BLOCK, n)
        return sum(f(net.gen_samples(n_min=k, n_max=k + step)).sum() for k in range(0, n, step)) / n

    return mean


def vegas_integrator(_):
    import gvar
    import vegas

    def mean(f, n, seed):
        gvar.ranseed(seed)
        integrator = vegas.Integrator([[0, 1]] * problems.DIM)
        iterations = 10  # the package's own default; the estimate weights them by their variances
        return integrator(vegas.batchintegrand(f), nitn=iterations, neval=max(n // iterations, 2)).mean

    return mean


KINDS = {"scipy-sobol": scipy_engine, "scipy-halton": scipy_engine, "qmcpy": qmcpy_net, "vegas": vegas_integrator}


def estimate(task):
    name, line, replicate = task
    problem, n, _, seed = problems.parse_job(line)
    return float(KINDS[name](name)(problems.function(problem), n, seed * 65536 + replicate))


def main():
    name = sys.argv[1]
    warnings.simplefilter("ignore")  # QMCPy recommends powers of 2 at every block
    KINDS[name](name)  # a package that is not there ends the process before the first job
    with multiprocessing.Pool(2) as pool:
        for line in sys.stdin:
            _, _, replicates, _ = problems.parse_job(line)
            tasks = [(name, line, r) for r in range(replicates)]
            start = time.perf_counter()
            estimates = pool.map(estimate, tasks, chunksize=1)
            seconds = time.perf_counter() - start
            print(seconds, *map(repr, estimates), flush=True)


if __name__ == "__main__":
    main()
