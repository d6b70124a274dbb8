"""The integrands of the comparison, as numbers that every peer is handed, and for NumPy.

They are koksma's entries of the same names with their default parameters, which are read from the entries
themselves; the coefficients are those of Genz (1984) and Sloan and Wozniakowski (1998) as the .cl files
beside the entries say. Exact values are not computed here: koksma reports them.
"""
import dataclasses
import json
import math
import pathlib

DIM = 8  # every peer's C++ code is compiled for it


@dataclasses.dataclass
class Problem:
    name: str
    constant: float  # phase of the oscillatory integrand, else 0
    coefficients: list  # of dimension 0, then of dimension 1, ...

    @property
    def scene(self):
        return f"{self.name}:d={DIM}"

    def job(self, n, replicates, seed):
        """The line that a worker is sent."""
        words = [self.name, DIM, n, replicates, seed, repr(self.constant), *map(repr, self.coefficients)]
        return " ".join(map(str, words))


def defaults(root, name):
    path = next(pathlib.Path(root).glob(f"integrands/*/{name}.json"))
    return {p["name"]: p["default"] for p in json.loads(path.read_text())["parameters"]}


def problems(root):
    """The three integrands; `root` is the repository."""
    product = defaults(root, "linear-prod")
    gaussian = defaults(root, "genz-gaussian")
    oscillatory = defaults(root, "genz-oscillatory")
    index = range(1, DIM + 1)
    difficulty = [(2 * j - 1) / DIM ** 2 for j in index]
    return [
        Problem("linear-prod", 0.0, [product["scale"] / j ** product["power"] for j in index]),
        Problem("genz-gaussian", 0.0,
                [c for j, a in zip(index, difficulty) for c in (gaussian["h"] * a, (2 + j % 7) / 11)]),
        Problem("genz-oscillatory", 2 * math.pi * oscillatory["w"], [oscillatory["h"] * a for a in difficulty]),
    ]


def parse_job(line):
    """A worker's side of Problem.job: the problem, N, replicates and seed."""
    name, _, n, replicates, seed, constant, *coefficients = line.split()
    return Problem(name, float(constant), [float(c) for c in coefficients]), int(n), int(replicates), int(seed)


def function(problem):
    """f of an array x[point][dimension], as NumPy's users write it."""
    import numpy
    c = numpy.array(problem.coefficients)
    if problem.name == "linear-prod":
        return lambda x: numpy.prod(1 + c * (x - 0.5), axis=1)
    if problem.name == "genz-gaussian":
        return lambda x: numpy.exp(-numpy.sum((c[::2] * (x - c[1::2])) ** 2, axis=1))
    if problem.name == "genz-oscillatory":
        return lambda x: numpy.cos(problem.constant + x @ c)
    raise ValueError(f"unknown integrand {problem.name}")
