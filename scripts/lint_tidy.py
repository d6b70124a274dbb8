#!/usr/bin/env python3
"""clang-tidy over the files of a compile database, several at a time: scripts/lint.sh calls this.

    lint_tidy.py ROOT BUILD [REGEX...]

Most of clang-tidy's time goes into the headers that a file includes, so files with the same command line
are checked in bundles, one file that includes the files of a folder, or of a few small ones. Where names
of two files collide, so that the bundle does not compile, the second makes a bundle with its like: what is
checked is the same.
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

BUNDLE = 48  # files: sixteen tests take 60 s, forty-four 75 s


def commands(root, build, patterns):
    """Sets of files by command line (without file and output) and by folder."""
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
        # main.cpp may define what headers declare: by itself.
        folder = path if path.name == "main.cpp" else path.parent
        groups.setdefault((entry["directory"], tuple(words)), {}).setdefault(folder, set()).add(path)
    return groups


def bundles(folders):
    """Lists of files: whole folders as long as they fit, larger ones cut."""
    merged, last = [], None
    for folder in sorted(folders):
        files = sorted(folders[folder])
        alone = folder.suffix != ""
        if last is not None and not alone and len(last) + len(files) <= BUNDLE:
            last += files
            continue
        cut = [files[i:i + BUNDLE] for i in range(0, len(files), BUNDLE)]
        merged += cut
        last = last if alone else cut[-1]
    return merged


class Linter:
    def __init__(self, root, build):
        self.root, self.folder = root, build / "bundles"
        self.folder.mkdir(exist_ok=True)
        self.header_filter = f"^{re.escape(str(root))}/(harness|tests)/"

    def bundle(self, files):
        """A file that includes `files`."""
        names = [f.relative_to(self.root).as_posix().replace("/", "_") for f in files]
        source = self.folder / f"{names[0]}-{names[-1]}.cpp"
        source.write_text("".join(f'#include "{f}"  // NOLINT(bugprone-suspicious-include)\n' for f in files))
        return source

    def apart(self, directory, words, files):
        """Those of `files` that do not compile beside the others, or at all."""
        run = subprocess.run([*words, "-w", "-fsyntax-only", "-ferror-limit=0", self.bundle(files)], cwd=directory,
                             text=True, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, check=False)
        blamed = {line.split(":")[0] for line in run.stderr.splitlines() if "error:" in line}
        return [f for f in files[1:] if str(f) in blamed] or files[1:]

    def check(self, directory, words, files):
        """The findings in `files`, as clang-tidy prints them."""
        source = self.bundle(files) if len(files) > 1 else files[0]
        run = subprocess.run(["clang-tidy", "--quiet", f"--config-file={self.root}/.clang-tidy",
                              f"--header-filter={self.header_filter}", source, "--", *words[1:]], cwd=directory,
                             text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False)
        if len(files) > 1 and "[clang-diagnostic-error" in run.stdout:
            apart = self.apart(directory, words, files)
            print(f"lint: apart from their folder, as names collide: {' '.join(f.name for f in apart)}", flush=True)
            return (self.check(directory, words, [f for f in files if f not in apart])
                    + self.check(directory, words, apart))
        if run.returncode == 0:
            return run.stdout
        noise = re.compile(r"^\d+ warnings?( and \d+ errors?)? generated\.$")
        findings = run.stdout + "".join(f"{line}\n" for line in run.stderr.splitlines() if not noise.match(line))
        return findings or f"clang-tidy failed on {source}\n"


def main():
    root, build = (pathlib.Path(p).resolve() for p in sys.argv[1:3])
    groups = commands(root, build, sys.argv[3:])
    count = sum(len(files) for folders in groups.values() for files in folders.values())
    jobs = os.cpu_count() or 1
    if count == 0:
        sys.exit(f"lint: no C++ file of harness/ or tests/ matches {sys.argv[3:]}")
    print(f"lint: clang-tidy on {count} files, {jobs} at a time", flush=True)
    linter, failed = Linter(root, build), False
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        work = [(*key, files) for key, folders in groups.items() for files in bundles(folders)]
        work.sort(key=lambda item: -len(item[-1]))  # the longest first
        pending = [pool.submit(linter.check, *item) for item in work]
        for done in concurrent.futures.as_completed(pending):
            failed |= done.result() != ""
            print(done.result(), end="", flush=True)
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
