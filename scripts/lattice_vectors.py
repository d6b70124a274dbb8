"""Builds and checks the generating vectors kernels/points/vectors/{cbc,korobov}.json.

Run in a virtual environment of its own (numpy is all it needs; two to four minutes on one core):

    python3 -m venv /tmp/lattice && /tmp/lattice/bin/pip install numpy
    /tmp/lattice/bin/python scripts/lattice_vectors.py            # writes both files
    /tmp/lattice/bin/python scripts/lattice_vectors.py --check    # verifies the committed ones

The vectors are embedded: the point set with 2^k points is {i z / 2^k mod 1}, for every k = 8..20.

Convention. alpha = 2 is the decay of the kernel, as in Cools, Kuo & Nuyens (2006):
    omega(x) = sum_{h != 0} exp(2 pi i h x) / |h|^2 = 2 pi^2 B_2(x),   gamma_j = 1 / j^2,
    e^2_{k,d}(z) = -1 + 2^-k sum_{i < 2^k} prod_{j <= d} (1 + gamma_j omega({i z_j / 2^k})).
So e^2 is the figure P_2 of the lattice, e decays like 1/N, and the integrands korobov_B2 (c_2 = 2 pi^2) have an
unshifted lattice error equal to a P_2. Other papers call this same space alpha = 1.

Criterion. Cools-Kuo-Nuyens divide the error at 2^k by that of the vector z^(k) which plain CBC builds for 2^k
alone, and take the maximum over k. Here the squared ratios are averaged instead:
    J_d(z) = mean_{k = 8..20} e^2_{k,d}(z) / e^2_{k,d}(z^(k)).
The mean is linear in the squared errors, so that one pass of FFTs serves all sizes at once. CBC minimises J_d for
each new z_d. Korobov minimises the mean of J_d over d in KOROBOV_DIMS.

Method. omega is even, so residues count up to sign and the odd ones modulo 2^l form the cyclic group <5> of order
2^(l-2). Grouping the points by their exact denominator 2^l turns each sum over points into one circular
correlation per level l (Nuyens & Cools, J. Complexity 22, 2006; Cools, Kuo & Nuyens, SIAM J. Sci. Comput. 28, 2006).
"""

import argparse
import json
import pathlib
import sys

import numpy as np

MIN_LOG2, MAX_LOG2, MAX_DIM = 8, 20, 1024
SIZES = range(MIN_LOG2, MAX_LOG2 + 1)
MODULUS = 1 << MAX_LOG2
ERROR_DIMS = (1, 2, 5, 10, 100, 1024)
KOROBOV_DIMS = (2, 4, 8, 16, 32)
KOROBOV_BEAM = 512
FOLDER = pathlib.Path(__file__).resolve().parent.parent / "kernels" / "points" / "vectors"


def omega(numerator, denominator):
    """2 pi^2 B_2(numerator / denominator) for numerators in [0, denominator), in extended precision."""
    x = np.asarray(numerator).astype(np.longdouble) / denominator
    two_pi_squared = 2 * np.longdouble("3.14159265358979323846264338327950288") ** 2
    return two_pi_squared * (x * (x - 1) + np.longdouble(1) / 6)


def group_order(level):
    """Number of odd residues modulo 2^level up to sign (1 for the levels 0, 1 and 2)."""
    return 1 << max(level - 2, 0)


def multiplicity(level):
    """How many lattice points share one residue class up to sign."""
    return 1 if level < 2 else 2


def powers_of_five(level):
    """5^b modulo 2^level for b = 0..group_order - 1; level 0 is the single point 0."""
    powers = np.empty(group_order(level), dtype=np.int64)
    powers[0], filled = 1 % (1 << level), 1
    while filled < powers.size:
        powers[filled : 2 * filled] = powers[:filled] * pow(5, filled, 1 << level) % (1 << level)
        filled *= 2
    return powers


def kernel_levels(max_log2):
    """omega on the points of each exact denominator 2^l, l = 0..max_log2, in the order of powers_of_five."""
    return [omega(powers_of_five(l), 1 << l).astype(np.float64) for l in range(max_log2 + 1)]


def smallest_representative(exponent, max_log2):
    """The smaller of z and -z modulo 2^max_log2, where z = 5^exponent."""
    z = pow(5, int(exponent), 1 << max_log2)
    return min(z, (1 << max_log2) - z)


def shifted(table, exponent):
    """omega at 5^exponent times the points of one level, given omega at the points."""
    return np.roll(table, -(exponent % table.size))


def level_weights(scale, sizes):
    """w_l such that sum_k scale_k 2^-k sum_{l <= k} S_l = sum_l w_l S_l."""
    top = max(sizes)
    return [sum(scale[k] / (1 << k) for k in sizes if k >= l) for l in range(top + 1)]


def criterion_of_all(products, kernels, spectra, weights):
    """sum_l w_l S_l(c) for every candidate 5^c, and a bound on the rounding errors of the transforms."""
    total, noise = np.zeros(1), 0.0
    for level, (p, w) in enumerate(zip(products, kernels)):
        # S_l has the period group_order(l), which doubles from level to level.
        if p.size > total.size:
            total = np.tile(total, 2)
        sums = np.fft.irfft(np.conj(np.fft.rfft(p)) * spectra[level], p.size) if p.size > 1 else p * w
        factor = weights[level] * multiplicity(level)
        total += factor * sums
        noise += factor * np.linalg.norm(p) * np.linalg.norm(w)
    return total, 16 * np.finfo(float).eps * noise


def criterion_of_one(products, kernels, weights, exponent):
    """The same sum for one candidate, without FFT and in extended precision."""
    return sum(
        weights[level] * multiplicity(level) * np.sum(p.astype(np.longdouble) * shifted(w, exponent))
        for level, (p, w) in enumerate(zip(products, kernels))
    )


def best_exponent(products, kernels, spectra, weights, max_log2):
    """Minimiser of the criterion. Near ties are settled directly, exact ties (z and 1/z at d = 2) by the smallest z:
    the result must not depend on how an FFT library rounds."""
    values, noise = criterion_of_all(products, kernels, spectra, weights)
    close = np.flatnonzero(values <= values.min() + noise)
    if close.size == 1:
        return int(close[0])
    close = close[np.argsort(values[close], kind="stable")][:64]
    exact = np.array([criterion_of_one(products, kernels, weights, c) for c in close])
    tied = close[exact <= exact.min() + noise / 1024]
    return int(min(tied, key=lambda c: smallest_representative(c, max_log2)))


def squared_errors(products, sizes):
    """e^2_k for every k in sizes, from the products at the points of each level."""
    excess = [multiplicity(l) * float(np.sum(p - 1)) for l, p in enumerate(products)]
    return {k: sum(excess[: k + 1]) / (1 << k) for k in sizes}


def build_cbc(sizes, max_dim, reference=None):
    """CBC for the sizes 2^k; returns z and e^2 by dimension (index d - 1) and k. reference[d - 1][k] normalises."""
    max_log2 = max(sizes)
    kernels = kernel_levels(max_log2)
    spectra = [np.fft.rfft(w) for w in kernels]
    products = [np.ones_like(w) for w in kernels]
    z, errors = [], []
    for d in range(1, max_dim + 1):
        scale = {k: 1 / reference[d - 1][k] if reference else 1.0 for k in sizes}
        weights = level_weights(scale, sizes)
        # One coordinate alone is the same grid for every odd z.
        exponent = best_exponent(products, kernels, spectra, weights, max_log2) if d > 1 else 0
        for p, w in zip(products, kernels):
            p *= 1 + shifted(w, exponent) / d**2
        z.append(smallest_representative(exponent, max_log2))
        errors.append(squared_errors(products, sizes))
    return z, errors


def build_reference(sizes, max_dim):
    """e^2 of the vector that plain CBC builds for each size alone: the normaliser of the criterion."""
    columns = {k: build_cbc([k], max_dim)[1] for k in sizes}
    return [{k: columns[k][d][k] for k in sizes} for d in range(max_dim)]


def korobov_level_sums(doubled, exponent, dims):
    """Sum over the points of one level of prod - 1 for z = (1, a, a^2, ...), a = 5^exponent, at each d in dims."""
    order = doubled.size // 2
    product, sums = np.ones(order), []
    for j in range(max(dims)):
        start = exponent * j % order
        product *= 1 + doubled[start : start + order] / (j + 1) ** 2
        if j + 1 in dims:
            sums.append(float(np.sum(product - 1)))
    return np.array(sums)


def search_korobov(reference):
    """Best generator a = ±5^b, b odd (a of full order modulo every 2^k, so that powers repeat as late as they can).

    e_k depends on a modulo 2^k only: the search lifts residue classes from 2^k to 2^(k+1). All classes are evaluated
    up to the first level with more than 2 KOROBOV_BEAM of them; from there on the KOROBOV_BEAM best go on.
    Nothing is lost by that: all 2^17 generators were evaluated once (in C), and the best one, the same as here, was
    among the best 6 classes at every level from 2^14 on.
    """
    kernels = kernel_levels(MAX_LOG2)
    beam = [(0.0, 0, np.zeros(len(KOROBOV_DIMS)))]  # mean ratio so far, exponent, sum of prod - 1 so far
    for level in range(MAX_LOG2 + 1):
        if level > 3:
            half = group_order(level) // 2
            beam = [(j, b + step, sums) for j, b, sums in beam for step in (0, half)]
        elif level == 3:
            beam = [(0.0, 1, beam[0][2])]
        doubled = np.concatenate([kernels[level]] * 2)
        grown = []
        for ratio, b, sums in beam:
            sums = sums + multiplicity(level) * korobov_level_sums(doubled, b, KOROBOV_DIMS)
            if level in SIZES:
                norm = np.array([reference[d - 1][level] for d in KOROBOV_DIMS])
                ratio += float(np.mean(sums / (1 << level) / norm)) / len(SIZES)
            grown.append((ratio, b, sums))
        beam = sorted(grown, key=lambda entry: entry[:2])[:KOROBOV_BEAM]
    finalists = [smallest_representative(b, MAX_LOG2) for _, b, _ in beam[:8]]
    return min(finalists, key=lambda a: (korobov_criterion(a, reference), a))


def korobov_vector(generator, max_dim):
    return [pow(generator, j, MODULUS) for j in range(max_dim)]


def korobov_criterion(generator, reference):
    direct = direct_squared_errors(korobov_vector(generator, max(KOROBOV_DIMS)), KOROBOV_DIMS)
    return float(np.mean([direct[k, d] / reference[d - 1][k] for k in SIZES for d in KOROBOV_DIMS]))


def direct_squared_errors(z, dims, sizes=SIZES):
    """e^2 by its definition, point by point in natural order, keyed by (k, d). Uses only x and 1 - x being alike."""
    top = max(sizes)
    modulus = 1 << top
    points = np.arange(modulus // 2 + 1, dtype=np.int64)
    table = omega(np.arange(modulus), modulus)
    product, errors = np.ones(points.size, dtype=np.longdouble), {}
    for d in range(1, max(dims) + 1):
        product *= 1 + table[points * (z[d - 1] % modulus) % modulus] / np.longdouble(d * d)
        for k in sizes if d in dims else ():
            excess = product[:: 1 << (top - k)] - 1
            errors[k, d] = float((2 * excess.sum() - excess[0] - excess[-1]) / (1 << k))
    return errors


def error_rows(z):
    errors = direct_squared_errors(z, ERROR_DIMS)
    return [{"log2_n": k, "d": d, "value": float(f"{errors[k, d] ** 0.5:.6e}")} for k in SIZES for d in ERROR_DIMS]


CRITERION = (
    "mean over k = 8..20 of e^2_{k,d}(z) / e^2_{k,d}(z^(k)), with z^(k) the plain CBC vector for 2^k points alone; "
    "e^2 = -1 + 2^-k sum_i prod_j (1 + gamma_j 2 pi^2 B_2(x_ij)), gamma_j = 1/j^2, kernel sum of |h|^-2; "
)


def describe(name, z, generator=None):
    """The content of one vector file."""
    texts = {
        "cbc": (
            "Embedded rank-1 lattice, component by component",
            "R. Cools, F. Y. Kuo, D. Nuyens, Constructing embedded lattice rules for multivariate integration, "
            "SIAM J. Sci. Comput. 28 (2006) 2162-2188",
            CRITERION + "minimised over odd z_d for d = 1..1024 in turn",
        ),
        "korobov": (
            "Embedded rank-1 lattice of Korobov type, z_j = a^(j-1)",
            "F. J. Hickernell, H. S. Hong, P. L'Ecuyer, C. Lemieux, Extensible lattice sequences for quasi-Monte "
            "Carlo quadrature, SIAM J. Sci. Comput. 22 (2000) 1117-1138",
            CRITERION + f"averaged over d in {list(KOROBOV_DIMS)}; minimised over a = 3 or 5 mod 8 by lifting residue "
            f"classes from 2^k to 2^(k+1), {KOROBOV_BEAM} best kept",
        ),
    }
    title, citation, criterion = texts[name]
    content = {"name": name, "title": title, "citation": citation, "space": {"alpha": 2, "weights": "1/j^2"}}
    content |= {"criterion": criterion, "log2_n": {"min": MIN_LOG2, "max": MAX_LOG2}}
    content |= {"generator": generator} if generator else {}
    return content | {"z": z, "worst_case_error": error_rows(z), "generated_by": "scripts/lattice_vectors.py"}


def to_text(content):
    """JSON with one key per line, 16 components of z per line and one size per line of errors."""
    lines = []
    for key, value in content.items():
        text = json.dumps(value)
        if isinstance(value, list):
            items = [json.dumps(item) for item in value]
            width = 16 if key == "z" else len(ERROR_DIMS)
            rows = [", ".join(items[i : i + width]) for i in range(0, len(items), width)]
            text = "[\n    " + ",\n    ".join(rows) + "\n  ]"
        lines.append(f"  {json.dumps(key)}: {text}")
    return "{\n" + ",\n".join(lines) + "\n}\n"


def write_files():
    reference = build_reference(SIZES, MAX_DIM)
    cbc, _ = build_cbc(SIZES, MAX_DIM, reference)
    generator = search_korobov(reference)
    files = {"cbc": describe("cbc", cbc)}
    files["korobov"] = describe("korobov", korobov_vector(generator, MAX_DIM), generator)
    for name, content in files.items():
        (FOLDER / f"{name}.json").write_text(to_text(content), encoding="utf-8")


def require(condition, statement):
    """Prints the statement that holds, or ends the run with the one that does not."""
    if not condition:
        raise SystemExit(f"FAILED: {statement}")
    print(f"ok: {statement}", flush=True)


def check_file(name):
    """Form of one committed file and its worst-case errors, recomputed point by point."""
    text = (FOLDER / f"{name}.json").read_text(encoding="utf-8")
    content = json.loads(text)
    z, generator = content["z"], content.get("generator")
    require(to_text(content) == text, f"{name}: the file is laid out as this script writes it")
    require(len(z) == MAX_DIM and all(0 < c < MODULUS and c % 2 for c in z), f"{name}: {MAX_DIM} odd components")
    if generator:
        require(z == korobov_vector(generator, MAX_DIM), f"{name}: the components are the powers of {generator}")
    else:
        require(max(z) < MODULUS // 2, f"{name}: every component is the smaller of z and -z")
    pairs = zip(content["worst_case_error"], error_rows(z), strict=True)
    worst = max(abs(old["value"] / new["value"] - 1) for old, new in pairs)
    require(worst < 1e-5, f"{name}: worst-case errors agree with the definition (largest difference {worst:.1e})")
    alone = [row for row in content["worst_case_error"] if row["d"] == 1]
    exact = all(abs(row["value"] * 2 ** row["log2_n"] * 3**0.5 / np.pi - 1) < 1e-5 for row in alone)
    require(exact, f"{name}: e = pi / (sqrt(3) N) at d = 1")
    return z


def direct_criterion(z, reference, sizes=SIZES):
    errors = direct_squared_errors(z, [len(z)], sizes)
    return np.mean([errors[k, len(z)] / reference[len(z) - 1][k] for k in sizes])


def check_small_construction():
    """The FFT construction equals trying every odd z by the definition, on sizes small enough for that."""
    sizes, dims = range(4, 10), 6
    reference = build_reference(sizes, dims)
    fast, _ = build_cbc(sizes, dims, reference)
    slow, odd = [1], range(1, 1 << (max(sizes) - 1), 2)
    while len(slow) < dims:
        values = [direct_criterion(slow + [c], reference, sizes) for c in odd]
        slow.append(next(c for c, v in zip(odd, values) if v <= min(values) * (1 + 1e-12)))
    require(fast == slow, f"fast CBC for 2^4..2^9 equals exhaustive search: {slow}")


def check_first_components(z, dims=5, draws=24):
    """The committed vector is what the search gives, and no drawn odd component does better by the definition."""
    reference = build_reference(SIZES, dims)
    require(build_cbc(SIZES, dims, reference)[0] == z[:dims], f"cbc: the first {dims} components are the minimisers")
    random = np.random.default_rng(1)
    for d in range(2, dims + 1):
        best = direct_criterion(z[:d], reference)
        drawn = [2 * int(c) + 1 for c in random.integers(0, MODULUS // 2, draws)]
        lowest = min(direct_criterion(z[: d - 1] + [c], reference) for c in drawn)
        require(best <= lowest, f"cbc: z_{d} beats {draws} random components ({best:.4f} against {lowest:.4f} at best)")


def check_files():
    check_small_construction()
    check_file("korobov")
    check_first_components(check_file("cbc"))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--check", action="store_true", help="verify the committed files instead of writing them")
    if not parser.parse_args().check:
        FOLDER.mkdir(parents=True, exist_ok=True)
        return write_files()
    return check_files()


if __name__ == "__main__":
    sys.exit(main())
