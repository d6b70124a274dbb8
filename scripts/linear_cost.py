#!/usr/bin/env python3
"""Cost against N to 2^36: time grows linearly in N d, and resident memory does not grow.

    scripts/linear_cost.py                        results/linear-cost.json and .png, some minutes
    scripts/linear_cost.py --largest 30 --dim 1 --dim 8
    scripts/linear_cost.py --plot results/linear-cost.json

Every point is a process of its own, `koksma run` of one N, of which the kernel time of one replicate and the
largest resident memory (getrusage) are taken: `sobol` in fp64, and in fp32 two replicates of
`sobol-lms-shift`, as one set of fp32 points ends at N = 2^23 (beyond, rows are marked grid_limited: their
time counts here, not their error). matplotlib is installed into build/peers.
"""
import argparse
import json
import math
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "scripts" / "peers"))

import environment  # noqa: E402

SAMPLERS = {"fp64": ("sobol", 1), "fp32": ("sobol-lms-shift", 2)}  # and replicates
FIRST = 2 ** 24  # N d from which on the slope is fitted: launches cost a ten-thousandth there


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--koksma", default="", help="the command; default: build/release/koksma or build/ci/koksma")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "results" / "linear-cost.json")
    parser.add_argument("--largest", type=int, default=36, metavar="LOG2", help="log2 of the largest N; default: 36")
    parser.add_argument("--dim", type=int, action="append", default=[], help="repeatable; default: 1, 2, 4, 8")
    parser.add_argument("--precision", choices=list(SAMPLERS), action="append", default=[],
                        help="repeatable; default: both")
    parser.add_argument("--longest", type=float, default=120.0, metavar="SECONDS",
                        help="an N that would take longer is left out of a curve; default: %(default)s")
    parser.add_argument("--note", default="", help="a remark for the context")
    parser.add_argument("--plot", type=pathlib.Path, metavar="FILE.json", help="draws a measured file, no more")
    options = parser.parse_args()
    if not 12 <= options.largest <= 52:
        parser.error(f"--largest {options.largest}: allowed are 12 to 52")
    given = [options.koksma] if options.koksma else [str(ROOT / "build" / p / "koksma") for p in ("release", "ci")]
    options.koksma = next((k for k in given if os.path.exists(k)), "")
    if not options.koksma and not options.plot:
        parser.error(f"no {' and no '.join(given)}: build koksma first, or give --koksma")
    return options


def measure(options, precision, dim, n, folder):
    """One process: kernel seconds, largest resident memory in KiB; and its context."""
    out = os.path.join(folder, "run.json")
    sampler, replicates = SAMPLERS[precision]
    command = [options.koksma, "run", "--quiet", "--scene", f"linear-prod:d={dim}", "--sampler", sampler,
               "--precision", precision, "--replicates", str(replicates), "--n", str(n), "--out", out]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    message = process.stderr.read().strip()
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        sys.exit(f"linear_cost: {' '.join(command)}: {message}")
    with open(out, encoding="utf-8") as file:
        results = json.load(file)
    cell = results["cells"][0]
    if cell["status"] != "ok":
        sys.exit(f"linear_cost: {' '.join(command)}: {cell['reason']}")
    row = cell["rows"][0]
    point = {"n": n, "kernel_s": row["kernel_s"]["min"] / replicates, "wall_s": row["wall_s"]["min"],
             "resident_kib": usage.ru_maxrss}
    return point, results["context"]


def curve(options, precision, dim, folder):
    points, context = [], None
    measure(options, precision, dim, 2 ** 12, folder)  # builds the program, which takes memory
    for exponent in range(12, options.largest + 1, 2):
        n = 2 ** exponent
        if points and points[-1]["wall_s"] * n / points[-1]["n"] > options.longest:
            print(f"linear_cost: {precision}, d = {dim} ends at N = 2^{exponent - 2}: more would take over {options.longest:g} s",
                  file=sys.stderr)
            break
        point, context = measure(options, precision, dim, n, folder)
        print(f"linear_cost: {precision}, d = {dim}, N = 2^{exponent}: {point['kernel_s']:.3g} s, "
              f"{point['resident_kib'] // 1024} MiB", file=sys.stderr, flush=True)
        points.append(point)
    return {"precision": precision, "d": dim, "points": points, **assess(points, dim)}, context


def assess(points, dim):
    """Slope of log time on log N, spread of the time of a coordinate and growth of memory, over N d >= FIRST."""
    large = [p for p in points if p["n"] * dim >= FIRST]
    if len(large) < 3:
        return {"slope": None, "ns_per_coordinate": None, "largest_to_smallest": None, "resident_growth": None}
    x = [math.log2(p["n"]) for p in large]
    y = [math.log2(p["kernel_s"]) for p in large]
    ns = [1e9 * p["kernel_s"] / (p["n"] * dim) for p in large]
    slope = statistics.linear_regression(x, y).slope
    resident = [p["resident_kib"] for p in large]
    return {"slope": slope, "ns_per_coordinate": statistics.median(ns), "largest_to_smallest": max(ns) / min(ns),
            "resident_growth": resident[-1] / resident[0]}


PLOT = """
import json, sys
import matplotlib
matplotlib.use("Agg")
import matplotlib.pyplot as plt
document = json.load(open(sys.argv[1]))
figure, (time, memory) = plt.subplots(1, 2, figsize=(11, 4.5))
for curve in document["curves"]:
    points = curve["points"]
    name = f"{curve['precision']}, d = {curve['d']}"
    label = name
    if curve["slope"] is not None:
        label += f", slope {curve['slope']:.3f}"
    time.loglog([p["n"] * curve["d"] for p in points], [p["kernel_s"] for p in points], "o-", label=label, base=2)
    memory.semilogx([p["n"] for p in points], [p["resident_kib"] / 1024 for p in points], "o-", label=name, base=2)
time.set_yscale("log", base=10)
time.set_xlabel("N d, coordinates")
time.set_ylabel("kernel time, s")
memory.set_xlabel("N")
memory.set_ylabel("largest resident memory, MiB")
memory.set_ylim(0, 1.25 * memory.get_ylim()[1])
for axes in (time, memory):
    axes.grid(True, alpha=0.3)
    axes.legend(loc="upper left" if axes is time else "lower right")
c = document["context"]
figure.suptitle(f"linear-prod, {c['device']['name']}, {c['date']}", fontsize=10)
figure.tight_layout()
figure.savefig(sys.argv[2], dpi=110)
"""


def plot(path):
    env = environment.Environment(ROOT / "build" / "peers", say=lambda text: print(f"linear_cost: {text}"))
    reason = env.package("matplotlib")
    picture = path.with_suffix(".png")
    if not reason:
        status, reason = environment.run([env.python, "-c", PLOT, path, picture], 300)
        reason = reason if status != 0 else ""
    print(f"no picture: {reason}" if reason else f"picture: {picture}")


def main():
    options = arguments()
    if options.plot:
        plot(options.plot)
        return
    curves, context = [], None
    with tempfile.TemporaryDirectory() as folder:
        for precision in options.precision or list(SAMPLERS):
            for dim in options.dim or [1, 2, 4, 8]:
                found, context = curve(options, precision, dim, folder)
                curves.append(found)
    keys = ("version", "revision", "build_type", "date", "host", "device")
    context = {"command": " ".join(["scripts/linear_cost.py", *sys.argv[1:]]), **{k: context[k] for k in keys},
               "samplers": SAMPLERS, "fitted_from_coordinates": FIRST,
               "note": options.note}
    options.out.write_text(json.dumps({"schema_version": 1, "context": context, "curves": curves}, indent=1) + "\n")
    for c in curves:
        if c["slope"] is not None:
            print(f"{c['precision']}, d = {c['d']}: time ~ N^{c['slope']:.3f}, {c['ns_per_coordinate']:.3f} ns a coordinate (largest to "
                  f"smallest {c['largest_to_smallest']:.2f}), resident memory x {c['resident_growth']:.2f} to N = "
                  f"2^{math.log2(c['points'][-1]['n']):g}")
    print(f"results: {options.out}")
    plot(options.out)


if __name__ == "__main__":
    main()
