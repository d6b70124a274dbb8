#!/usr/bin/env python3
"""koksma and its peers side by side: the same integrands, N and machine, in one run.

    scripts/peers.py                     everything into results/peers.json, and a table
    scripts/peers.py --quick             two peers that need no network, small N, to see that it works
    scripts/peers.py --only mkl-sobol-fp32 --only koksma-sobol-fp32
    scripts/peers.py --table results/peers.json

Peers and what they need are in scripts/peers/peers.json. Python packages go into an environment of their own
in build/peers, Debian packages (libgsl-dev) are installed as by scripts/install.sh. A peer that can not be
had is a row with the reason. Contenders alternate over rounds, each with two threads or processes (the
packages of Python: two processes); ratios are of minima.
"""
import argparse
import datetime
import json
import pathlib
import platform
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "scripts" / "peers"))

import assess  # noqa: E402
import environment  # noqa: E402
import measure  # noqa: E402
import problem as problem_file  # noqa: E402
import table  # noqa: E402

SEED = 1
SCHEMA_VERSION = 1


def say(text):
    print(f"peers: {text}", file=sys.stderr, flush=True)


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--koksma", help="the command; default: the newest of build/release and build/ci")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "results" / "peers.json")
    parser.add_argument("--only", action="append", default=[], metavar="NAME", help="a row by its name; repeatable")
    parser.add_argument("--quick", action="store_true", help="small N, few peers, nothing is installed")
    parser.add_argument("--integrand", action="append", default=[], metavar="NAME", help="one of them; repeatable")
    parser.add_argument("--no-install", action="store_true", help="use what is there")
    parser.add_argument("--rounds", type=int, default=9)
    parser.add_argument("--patience", type=float, default=10.0, metavar="SECONDS",
                        help="a contender that has measured so long leaves the rounds; default: %(default)s")
    parser.add_argument("--note", default="", help="a remark for the context, such as what else the machine did")
    parser.add_argument("--table", type=pathlib.Path, metavar="FILE.json", help="print the tables of a file, no more")
    options = parser.parse_args()
    if options.rounds < 1:
        parser.error(f"--rounds {options.rounds}: at least 1")
    return parser, options


def find_koksma(parser, given):
    candidates = [pathlib.Path(given)] if given else [ROOT / "build" / p / "koksma" for p in ("release", "ci")]
    found = [c for c in candidates if c.exists()]
    if not found:
        parser.error(f"no {' and no '.join(map(str, candidates))}: build koksma first, or give --koksma")
    return str(max(found, key=lambda c: c.stat().st_mtime).resolve())


def chosen(parser, peers, only):
    """Entries of peers, subjects and end-to-end rows that were asked for."""
    groups = {"peers": peers["peers"], "subjects": peers["subjects"],
              "end_to_end": [dict(e, name="end-to-end-" + e["name"], package=e["name"]) for e in peers["end_to_end"]]}
    names = [e["name"] for entries in groups.values() for e in entries]
    unknown = [name for name in only if name not in names]
    if unknown:
        parser.error(f"--only {unknown[0]}: there is no such row; there are {', '.join(names)}")
    return {k: [e for e in entries if not only or e["name"] in only] for k, entries in groups.items()}


def chosen_problems(parser, options):
    problems = problem_file.problems(ROOT)
    names = [p.name for p in problems]
    for name in options.integrand:
        if name not in names:
            parser.error(f"--integrand {name}: there are {', '.join(names)}")
    wanted = options.integrand or (names[:1] if options.quick else names)
    return [p for p in problems if p.name in wanted]


def context_of(koksma_context, problems, options, sizes, n, replicates):
    processor = next((line.split(":", 1)[1].strip() for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines()
                      if line.startswith("model name")), platform.processor())
    return {
        "command": " ".join(["scripts/peers.py", *sys.argv[1:]]),
        "date": datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ"),
        "version": koksma_context["version"], "revision": koksma_context["revision"],
        "build_type": koksma_context["build_type"], "device": koksma_context["device"],
        "host": {"processor": processor, "cores": 2, "python": platform.python_version(),
                 "compiler": environment.run(["g++", "-dumpfullversion"], 60)[1],
                 "flags": " ".join(environment.FLAGS)},
        "note": options.note, "dimension": problem_file.DIM, "integrands": [p.name for p in problems], "n": n,
        "replicates": replicates, "rounds": options.rounds, "curve": sizes, "seed": SEED,
    }


class Comparison:
    """Contenders and the rows they fill."""

    def __init__(self, peers, groups, env, koksma, folder, exact):
        self.env, self.rows, self.contenders = env, {}, []
        for entry in groups["subjects"]:
            self.add(entry, "subject", "", measure.Koksma(entry, koksma, folder))
        for entry in groups["peers"]:
            try:
                command = measure.peer_command(entry, peers, env)
                self.add(entry, "peer", self.version(entry), measure.Peer(entry, command, exact))
            except measure.Failure as failure:
                say(f"{entry['name']}: {failure}")
                self.add(entry, "peer", "", None)
                self.rows[entry["name"]].update(status="unavailable", reason=str(failure))

    def version(self, entry):
        return self.env.package_version(entry["version_of"]) or self.env.debian_version(entry["version_of"])

    def add(self, entry, kind, version, contender):
        keys = ("name", "title", "points", "precision", "randomized")
        row = {k: entry[k] for k in keys}
        row.update(kind=kind, version=version, status="ok", reason="", problems=[])
        self.rows[entry["name"]] = row
        if contender is not None:
            self.contenders.append(contender)

    def drop(self, contender, reason):
        name = contender.entry["name"]
        say(f"{name}: {reason}")
        self.rows[name].update(status="failed", reason=reason)
        self.contenders.remove(contender)
        contender.stop()

    def curves(self, problem, sizes, replicates):
        found = {}
        for contender in list(self.contenders):
            say(f"{problem.name}: {contender.entry['name']}, error against N")
            try:
                found[contender.entry["name"]] = measure.curve_of(contender, problem, sizes, replicates, SEED)
            except measure.Failure as failure:
                self.drop(contender, str(failure))
        return found

    def measure(self, problem, sizes, n, replicates, options):
        """Curves of all, N their last point, then the rounds at N in jobs of about the same duration."""
        curves = self.curves(problem, sizes, replicates)
        say(f"{problem.name}: rounds")
        per_job = {name: measure.replicates_for(curve[-1]["seconds"]) for name, curve in curves.items()}
        times, failures = measure.rounds_of(self.contenders, problem, n, per_job, options.rounds, options.patience, SEED)
        for contender in list(self.contenders):
            name = contender.entry["name"]
            if name in failures:
                self.drop(contender, failures[name])
                continue
            seconds, curve = sorted(times[name]), curves[name]
            curve[-1]["seconds"] = min(curve[-1]["seconds"], seconds[0])
            self.rows[name]["problems"].append({
                "integrand": problem.name, "n": n,
                "seconds_per_n": {"min": seconds[0], "median": seconds[len(seconds) // 2], "count": len(seconds)},
                "points_per_s": n / seconds[0], "error": curve[-1]["error"], "curve": curve,
                **assess.times_to(curve)})


def seconds_of(command):
    start = time.perf_counter()
    done = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, check=False)
    if done.returncode != 0:
        raise measure.Failure((done.stderr.strip().splitlines() or ["no message"])[-1])
    return time.perf_counter() - start


def end_to_end(peers, entries, env, koksma, folder, problem, rounds):
    """Whole processes: `koksma run`, its program cache warm, against the same study in Python."""
    n, replicates = peers["end_to_end_size"]["n"], peers["end_to_end_size"]["replicates"]
    common = [koksma, "run", "--scene", problem.scene, "--sampler", "sobol-lms-shift", "--n", str(n), "--replicates",
              str(replicates), "--out", f"{folder}/end.json"]
    # As it is run, timing the row by several launches, and what the peer does: every replicate once.
    own = {f"koksma run{''.join(' ' + word for word in more)}, {precision}": [*common, "--precision", precision, *more]
           for more in ([], ["--launches", "1"]) for precision in ("fp64", "fp32")}
    headlines, failures = [], []
    for entry in entries:
        reason = env.packages(peers["packages"][entry["packages"]])
        if reason:
            failures.append({"name": entry["name"], "reason": reason})
            continue
        script = environment.HERE / "end_to_end.py"
        other = [env.python, script, entry["package"], str(n), str(replicates), problem.job(n, replicates, SEED)]
        times = {name: [] for name in [*own, entry["name"]]}
        try:
            for command in own.values():
                seconds_of(command)  # fills the program cache
            for _ in range(rounds):
                for name, command in [*own.items(), (entry["name"], other)]:
                    times[name].append(seconds_of(command))
        except measure.Failure as failure:
            failures.append({"name": entry["name"], "reason": str(failure)})
            continue
        for name in own:
            row = assess.headline("end to end, the whole process", problem.name, n, (name, min(times[name])),
                                  (entry["name"], min(times[entry["name"]])), peers["end_to_end_size"]["required"])
            row.update(replicates=replicates, subject_s=min(times[name]), peer_s=min(times[entry["name"]]))
            headlines.append(row)
    return headlines, failures


def compare(parser, options):
    peers = json.loads((ROOT / "scripts" / "peers" / "peers.json").read_text())
    groups = chosen(parser, peers, options.only or (peers["quick"] if options.quick else []))
    size = peers["quick_size" if options.quick else "size"]
    if options.quick:  # factors are asked for at the full N
        options.rounds = min(2, options.rounds)
        groups["subjects"] = [{k: v for k, v in e.items() if k != "required"} for e in groups["subjects"]]
    sizes, n, replicates = size["curve"], size["n"], size["replicates"]
    koksma = find_koksma(parser, options.koksma)
    problems = chosen_problems(parser, options)
    env = environment.Environment(ROOT / "build" / "peers", not (options.quick or options.no_install), say)
    with tempfile.TemporaryDirectory() as folder:
        exact, koksma_context = measure.exact_values(koksma, folder, problems)
        comparison = Comparison(peers, groups, env, koksma, folder, exact)
        for problem in problems:
            comparison.measure(problem, sizes, n, replicates, options)
        for contender in comparison.contenders:
            contender.stop()
        rows = list(comparison.rows.values())
        headlines = [h for p in problems for h in assess.throughput_headlines(rows, p.name, groups["subjects"])]
        if groups["end_to_end"]:
            say("end to end")
        whole, failures = end_to_end(peers, groups["end_to_end"], env, koksma, folder, problems[0],
                                     min(3, options.rounds))
    return {"schema_version": SCHEMA_VERSION,
            "context": context_of(koksma_context, problems, options, sizes, n, replicates),
            "exact": exact, "tolerances": assess.TOLERANCES, "rows": rows,
            "headlines": headlines + whole, "end_to_end_failures": failures}


def main():
    parser, options = arguments()
    if options.table:
        print(table.table(json.loads(options.table.read_text())))
        return
    document = compare(parser, options)
    options.out.write_text(json.dumps(document, indent=1, allow_nan=False) + "\n")
    print(table.table(document))
    print(f"\nresults: {options.out}")


if __name__ == "__main__":
    main()
