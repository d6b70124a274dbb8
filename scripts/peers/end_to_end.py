"""A Python user's program, timed as a whole process: 32 randomizations of N Sobol' points, their mean and
standard error.

    end_to_end.py scipy|qmcpy N REPLICATES JOB

JOB is the line of problem.py's job; its N and replicates are not used.
"""
import sys
import warnings

import numpy

import problem as problems


def points(package, n, seed):
    if package == "scipy":
        from scipy.stats import qmc
        return qmc.Sobol(problems.DIM, scramble=True, rng=seed).random(n)
    import qmcpy
    return qmcpy.DigitalNetB2(problems.DIM, seed=seed, randomize="LMS_DS").gen_samples(n)


def main():
    package, n, replicates, line = sys.argv[1], int(sys.argv[2]), int(sys.argv[3]), sys.argv[4]
    warnings.simplefilter("ignore")
    f = problems.function(problems.parse_job(line)[0])
    means = numpy.array([f(points(package, n, seed)).mean() for seed in range(replicates)])
    print(means.mean(), means.std(ddof=1) / numpy.sqrt(replicates))


if __name__ == "__main__":
    main()
