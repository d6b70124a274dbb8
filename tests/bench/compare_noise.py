#!/usr/bin/env python3
"""Does `koksma compare` ignore noise and find a slowdown of 30 %? Three kinds of tries, on this machine as it is:

  same     two runs of the same build: they must not differ
  scaled   the same pairs, the times of the new run multiplied by 1.3 in its file: must be found
  slower   a user's integrand against the same with about 30 % more work in its loop: must be found

Every pair is two consecutive runs. Writes command, device, dates, loads and counts as JSON; exit status 1 where
there is more than none of 20 false alarms, or less than 19 of 20 are found. With 20 tries an observed rate is known
to about 0.05 only. Not a CI test: it takes minutes, and half of it is chance.

  tests/bench/compare_noise.py --koksma build/release/koksma --out results/compare-noise.json
"""
import argparse
import datetime
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

FACTOR = 1.3
WORK, MORE_WORK = 200, 260  # rounds of the loop: 30 % more, of a kernel that does little else
DIMENSIONS = (1, 2, 3, 4)  # with three samplers: a run lasts longer than what disturbs the machine mostly does

CODE = """// planted: x_0 + ... under an idle loop whose length is what is compared.
#ifdef KOKSMA_EXACT
static double exact_mean(params q, uint d) { return 0.5; }
#else
static inline real integrand(points *p, params q, coefficients c) {
  real x = R(0.0);
  for (uint j = 0; j < KOKSMA_DIM; ++j) { const real u = points_next(p); if (j == 0) x = u; }
  real y = x;
  for (uint i = 0; i < %d; ++i) y = fma(y, R(0.5), x * R(0.5));
  return y;
}
#endif
"""
ENTRY = {
    "name": "planted", "title": "A loop of known length", "citation": "tests/bench/compare_noise.py", "reference": [],
    "class": "smooth", "periodic": False, "parameters": [], "dimensions": {"min": 1, "max": 100, "default": 2},
    "draws": "d", "coefficients": [], "transforms": [], "exact_operations": True, "nonnegative": True,
    "exact": {"mean": {"from": "formula"}, "mean_abs": {"from": "mean"}}, "checks": [],
}


def run(koksma, out, arguments):
    subprocess.run([koksma, "run", "--quiet", "--out", str(out), *arguments], check=True)
    return json.loads(out.read_text())


def compare(koksma, base, new):
    """(status, comparison) of two files; any status but 0 and 1 ends the script."""
    done = subprocess.run([koksma, "compare", str(base), str(new), "--json"], capture_output=True, text=True)
    if done.returncode not in (0, 1):
        sys.exit(f"compare_noise: koksma compare: {done.stderr}")
    return done.returncode, json.loads(done.stdout)


def entry_of(kind, status, comparison, loads):
    cells = [c for c in comparison["cells"] if c["regression"]]
    return {"kind": kind, "regression": status == 1, "study_ratio": comparison["study"]["ratio"],
            "study_p": comparison["study"]["p"], "study": comparison["study"]["change"],
            "undecided": comparison["undecided"], "calibration_ratio": comparison["calibration_ratio"],
            "calibration_followed": comparison["calibration_followed"], "clock_ratio": comparison["clock_ratio"],
            "cells_worse": len(cells),
            "worst_cell_ratio": max(c["time"]["ratio"] or 0 for c in comparison["cells"]),
            "row_spread": comparison["row_spread"], "cell_spread": comparison["cell_spread"],
            "cells": len(comparison["cells"]), "load": loads}


def scaled(path, out):
    results = json.loads(path.read_text())
    for cell in results["cells"]:
        for row in cell["rows"]:
            row["kernel_times_s"] = [FACTOR * t for t in row["kernel_times_s"]]
            for key in ("median", "min", "spread"):
                row["kernel_s"][key] *= FACTOR
    out.write_text(json.dumps(results))


def calibration_share(results):
    """Calibration's share of the timed launches, each row's calibrations counted as often as they are shared: an
    upper bound."""
    timed = sum(
        r.get("runs_per_launch", 1) * sum(r["kernel_times_s"]) for c in results["cells"] for r in c["rows"]
    )
    distinct = sum(len(set(r["calibration_s"])) * min(r["calibration_s"]) for c in results["cells"] for r in c["rows"])
    return distinct / timed


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--koksma", required=True)
    parser.add_argument("--out", required=True)
    parser.add_argument("--tries", type=int, default=20)
    parser.add_argument("--study", help="of the first two kinds; default: the default study")
    options = parser.parse_args()
    koksma = str(Path(options.koksma).resolve())
    study = [str(Path(options.study).resolve())] if options.study else []
    started = datetime.datetime.now(datetime.timezone.utc)
    tries = []
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        integrands = {}
        for work in (WORK, MORE_WORK):
            place = folder / str(work)
            place.mkdir()
            (place / "planted.json").write_text(json.dumps(ENTRY))
            (place / "planted.cl").write_text(CODE % work)
            integrands[work] = ["--integrand", str(place / "planted.json")]
            for d in DIMENSIONS:
                integrands[work] += ["--scene", f"planted:d={d}"]
            for sampler in ("sobol-owen", "random", "lattice-shift"):
                integrands[work] += ["--sampler", sampler]
        base, new, other = folder / "base.json", folder / "new.json", folder / "other.json"
        first = run(koksma, base, study)
        for k in range(options.tries):
            second = run(koksma, new, study)
            loads = round(os.getloadavg()[0], 2)
            tries.append(entry_of("same", *compare(koksma, base, new), loads))
            scaled(new, other)
            tries.append(entry_of("scaled", *compare(koksma, base, other), loads))
            new.replace(base)
            run(koksma, other, integrands[WORK])
            run(koksma, new, integrands[MORE_WORK])
            tries.append(entry_of("slower", *compare(koksma, other, new), loads))
            print(f"try {k + 1}: " + ", ".join(f"{t['kind']} {'REGRESSION' if t['regression'] else 'same'} "
                                               f"({t['study_ratio']:.3f})" for t in tries[-3:]), flush=True)
    found = {kind: sum(t["regression"] for t in tries if t["kind"] == kind) for kind in ("same", "scaled", "slower")}
    ratios = sorted(t["study_ratio"] for t in tries if t["kind"] == "slower")
    report = {
        "command": "tests/bench/compare_noise.py " + " ".join(sys.argv[1:]), "date": started.isoformat(timespec="seconds"),
        "device": first["context"]["device"], "host_cores": os.cpu_count(), "version": first["context"]["version"],
        "revision": first["context"]["revision"], "tries": options.tries, "regressions": found,
        "asked": {"same": "0 of 20", "scaled": "at least 19 of 20", "slower": "at least 19 of 20"},
        "slower_median_ratio": ratios[len(ratios) // 2], "calibration_share_at_most": calibration_share(second),
        "details": tries,
    }
    Path(options.out).write_text(json.dumps(report, indent=1) + "\n")
    print(f"regressions of {options.tries}: {found}; calibration at most {100 * report['calibration_share_at_most']:.1f} % "
          "of the launches")
    enough = 0.95 * options.tries
    return 0 if found["same"] == 0 and min(found["scaled"], found["slower"]) >= enough else 1


if __name__ == "__main__":
    sys.exit(main())
