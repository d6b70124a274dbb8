"""Runs peers and koksma on the same jobs: N points, R replicates, both cores.

A contender has measure(problem, n, replicates, seed) -> (seconds of all replicates, error of one estimate):
the RMSE over the replicates where they are randomized, else the error of the one set there is.
"""
import json
import math
import os
import selectors
import statistics
import subprocess
import tempfile

import environment


class Failure(Exception):
    """A contender that can not be had or does not answer; its text is the row's reason."""


class Peer:
    """A process that answers jobs, started at the first."""

    def __init__(self, entry, command, exact):
        self.entry, self.command, self.exact, self.process = entry, command, exact, None
        self.log = tempfile.TemporaryFile(mode="w+")

    def start(self):
        self.process = subprocess.Popen(self.command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self.log,
                                        text=True, bufsize=1)

    def measure(self, problem, n, replicates, seed):
        if self.process is None:
            self.start()
        try:
            self.process.stdin.write(problem.job(n, replicates, seed) + "\n")
            answer = self.answer(600)
        except OSError:
            answer = ""
        if not answer:
            raise Failure(f"it ended without an answer: {self.last_words()}")
        seconds, *estimates = map(float, answer.split())
        errors = [e - self.exact[problem.name] for e in estimates]
        return seconds, math.sqrt(statistics.fmean(e * e for e in errors))

    def answer(self, timeout):
        with selectors.DefaultSelector() as selector:
            selector.register(self.process.stdout, selectors.EVENT_READ)
            if not selector.select(timeout):
                self.process.kill()
                raise Failure(f"no answer within {timeout} s")
        return self.process.stdout.readline()

    def last_words(self):
        self.process.wait(10)
        self.log.seek(0)
        return (self.log.read().strip().splitlines() or ["nothing was printed"])[-1]

    def stop(self):
        if self.process is not None:
            self.process.stdin.close()
            try:
                self.process.wait(30)
            except subprocess.TimeoutExpired:
                self.process.kill()


class Koksma:
    """The subject: `koksma run --out`, whose row of N has the wall time of all replicates, launch and reading back
    included."""

    def __init__(self, entry, command, folder):
        self.entry, self.command, self.out = entry, command, os.path.join(folder, "koksma.json")

    def run(self, problem, n, replicates, seed):
        arguments = ["run", "--scene", problem.scene, "--sampler", self.entry["sampler"], "--precision",
                     self.entry["precision"], "--n", str(n), "--replicates", str(replicates), "--seed", str(seed),
                     "--out", self.out, "--quiet"]
        done = subprocess.run([self.command, *arguments], stderr=subprocess.PIPE, text=True, check=False)
        if done.returncode != 0:
            raise Failure((done.stderr.strip().splitlines() or ["no message"])[-1])
        with open(self.out, encoding="utf-8") as file:
            results = json.load(file)
        if results["cells"][0]["status"] != "ok":
            raise Failure(results["cells"][0]["reason"])
        return results

    def measure(self, problem, n, replicates, seed):
        row = self.run(problem, n, replicates, seed)["cells"][0]["rows"][0]
        return row["wall_s"]["min"], row["rmse"]

    def stop(self):
        pass


def exact_values(command, folder, problems):
    """Exact integrals as koksma knows them, and its context."""
    koksma = Koksma({"sampler": "sobol-lms-shift", "precision": "fp64"}, command, folder)
    results = [koksma.run(p, 256, 2, 1) for p in problems]
    exact = {p.name: r["cells"][0]["scene"]["exact"]["mean"]["value"] for p, r in zip(problems, results)}
    return exact, results[0]["context"]


def peer_command(entry, peers, env):
    """The command of a peer, installed and built; Failure with the reason where it can not be had."""
    def need(reason):
        if reason:
            raise Failure(reason)

    program = peers["programs"].get(entry.get("program"), {})
    packages = program.get("packages") or entry.get("packages")
    if "debian" in program:
        need(env.debian(**peers["debian"][program["debian"]]))
    if packages:
        need(env.packages(peers["packages"][packages]))
    values = {}
    if any("{matrices}" in a for a in entry["arguments"]):
        values["matrices"], reason = env.matrices()
        need(reason)
    if any("{qmctoolscl_library}" in a for a in entry["arguments"]):
        values["qmctoolscl_library"] = env.qmctoolscl_library()
        need("" if values["qmctoolscl_library"] else "qmctoolscl holds no shared library")
    arguments = [a.format(**values) for a in entry["arguments"]]
    if program:
        path, reason = env.program(entry["program"], program["libraries"])
        need(reason)
        return [str(path), *arguments]
    return [str(env.python), str(environment.HERE / entry["script"]), *arguments]


def curve_of(contender, problem, sizes, replicates, seed):
    """Error and seconds of one estimate, by N. The first job is not kept: it starts and warms up."""
    contender.measure(problem, sizes[0], 2, seed)
    points = []
    for n in sizes:
        seconds, error = contender.measure(problem, n, replicates, seed)
        points.append({"n": n, "error": error, "seconds": seconds / replicates})
    return points


JOB = 0.05  # seconds, about: as long for the fast as for the slow, so that what else runs disturbs them alike


def replicates_for(seconds):
    """An even number of estimates that take about JOB, for two threads; at most 64."""
    return max(2, min(64, 2 * round(JOB / (2 * seconds))))


def rounds_of(contenders, problem, n, replicates, rounds, patience, seed):
    """Seconds per N points of every contender in alternation, by name; and the reasons of those that failed.

    replicates: of each job, by name. A contender leaves once it has used up `patience` seconds."""
    times, failures = {c.entry["name"]: [] for c in contenders}, {}
    for _ in range(rounds):
        for contender in contenders:
            name = contender.entry["name"]
            if name in failures or sum(times[name]) * replicates[name] > patience:
                continue
            try:
                seconds, _ = contender.measure(problem, n, replicates[name], seed)
                times[name].append(seconds / replicates[name])
            except Failure as failure:
                failures[name] = str(failure)
    return times, failures
