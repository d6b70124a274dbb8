#!/usr/bin/env python3
"""clang-tidy over the files of a compile database, several at a time: scripts/lint.sh calls this.

    lint_tidy.py ROOT BUILD [REGEX...]

Most of clang-tidy's time goes into the headers that a file includes, so files with the same command line
are checked in bundles, one file that includes them all. Where names of two files collide, so that the
bundle does not compile, the second makes a bundle with its like: what is checked is the same.
Prints only findings in ROOT/harness and ROOT/tests; exit status 1 where there is one.
"""
import concurrent.futures
import json
import os
import pathlib
import re
import shlex
import subprocess
import sys

BUNDLE = 16  # files; more saves little, and leaves less to share out between processors


def commands(root, build, patterns):
    """Files by command line (without file and output), sorted by path."""
    groups = {}
    for entry in json.loads((build / "compile_commands.json").read_text()):
        path = pathlib.Path(entry["file"])
        if not path.is_relative_to(root) or path.relative_to(root).parts[0] not in ("harness", "tests"):
            continue
        if patterns and not any(re.search(p, str(path.relative_to(root))) for p in patterns):
            continue
        words = shlex.split(entry["command"])
        for flag in ("-o", "-c"):
            at = words.index(flag)
            del words[at:at + 2]
        groups.setdefault((entry["directory"], tuple(words)), set()).add(path)
    return groups


class Linter:
    def __init__(self, root, build):
        self.root, self.folder = root, build / "bundles"
        self.folder.mkdir(exist_ok=True)
        self.header_filter = f"^{re.escape(str(root))}/(harness|tests)/"

    def bundle(self, directory, words, files):
        """A file that includes `files`, and those among them that do not compile beside the others."""
        names = [f.relative_to(self.root).as_posix().replace("/", "_") for f in files]
        source = self.folder / f"{names[0]}-{names[-1]}.cpp"
        source.write_text("".join(f'#include "{f}"  // NOLINT(bugprone-suspicious-include)\n' for f in files))
        run = subprocess.run([*words, "-w", "-fsyntax-only", "-ferror-limit=0", source], cwd=directory, text=True,
                             stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, check=False)
        blamed = {line.split(":")[0] for line in run.stderr.splitlines() if "error:" in line}
        apart = [f for f in files[1:] if str(f) in blamed]
        return source, apart if apart or run.returncode == 0 else files[1:]

    def check(self, directory, words, files):
        """The findings in `files`, as clang-tidy prints them."""
        apart, source = [], files[0]
        while len(files) > 1:
            source, colliding = self.bundle(directory, words, files)
            if not colliding:
                break
            apart = sorted([*apart, *colliding])
            files = [f for f in files if f not in colliding]
            source = files[0]
        run = subprocess.run(["clang-tidy", "--quiet", f"--config-file={self.root}/.clang-tidy",
                              f"--header-filter={self.header_filter}", source, "--", *words[1:]], cwd=directory,
                             text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False)
        noise = re.compile(r"^\d+ warnings?( and \d+ errors?)? generated\.$")
        findings = run.stdout
        if run.returncode != 0:
            findings += "".join(f"{line}\n" for line in run.stderr.splitlines() if not noise.match(line))
            findings = findings or f"clang-tidy failed on {source}\n"
        return findings + (self.check(directory, words, apart) if apart else "")


def main():
    root, build = (pathlib.Path(p).resolve() for p in sys.argv[1:3])
    groups = commands(root, build, sys.argv[3:])
    count, jobs = sum(map(len, groups.values())), os.cpu_count() or 1
    if count == 0:
        sys.exit(f"lint: no C++ file of harness/ or tests/ matches {sys.argv[3:]}")
    print(f"lint: clang-tidy on {count} files, {jobs} at a time", flush=True)
    linter, failed = Linter(root, build), False
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        pending = []
        for (directory, words), files in groups.items():
            ordered = sorted(files)
            pending += [pool.submit(linter.check, directory, words, ordered[i:i + BUNDLE])
                        for i in range(0, len(ordered), BUNDLE)]
        for done in concurrent.futures.as_completed(pending):
            failed |= done.result() != ""
            print(done.result(), end="", flush=True)
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
