"""What the peers need: a Python environment of their own, Debian packages, programs built here.

Everything lies in one folder (build/peers), safe to delete. Nothing raises: a peer that can not be had gets
the reason, which becomes its row.
"""
import os
import pathlib
import shutil
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
# The peers may use everything this processor has, reorder sums and call the vector math library.
FLAGS = ["-std=c++20", "-O3", "-march=native", "-ffast-math", "-pthread"]


def run(command, timeout):
    """The exit status and the last line that was printed."""
    try:
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=timeout,
                              stdin=subprocess.DEVNULL, check=False)
    except (OSError, subprocess.TimeoutExpired) as error:
        return 1, str(error)
    lines = [line for line in done.stdout.strip().splitlines() if line.strip() and "notice" not in line]
    return done.returncode, lines[-1].strip() if lines else ""


class Environment:
    """install=False: what is there is used, nothing is fetched."""

    def __init__(self, folder, install=True, say=lambda text: None):
        self.folder, self.install, self.say = pathlib.Path(folder).resolve(), install, say
        self.venv = self.folder / "venv"
        self.python = self.venv / "bin" / "python"
        self.problems = {}  # reason by package, "" where it is there
        self.updated = False
        self.folder.mkdir(parents=True, exist_ok=True)

    # Python packages

    def has_package(self, package):
        check = f"import importlib.metadata as m; m.version('{package}')"
        return self.python.exists() and run([self.python, "-c", check], 60)[0] == 0

    def package_version(self, package):
        check = f"import importlib.metadata as m; print(m.version('{package}'))"
        status, line = run([self.python, "-c", check], 60)
        return line if status == 0 else ""

    def package(self, package):
        """Installs one package where it is missing; the reason if it can not be had."""
        if package not in self.problems:
            self.problems[package] = self.install_package(package)
        return self.problems[package]

    def install_package(self, package):
        if self.has_package(package):
            return ""
        if not self.install:
            return f"{package} is not installed, and --no-install was given"
        if not self.python.exists():
            status, line = run([sys.executable, "-m", "venv", self.venv], 300)
            if status != 0:
                return f"no Python environment: {line}"
        self.say(f"installing {package}")
        pip = [self.python, "-m", "pip", "install", "-q", "--disable-pip-version-check", "--retries", "1"]
        status, line = run([*pip, "--timeout", "20", package], 1200)
        return "" if status == 0 and self.has_package(package) else f"pip install {package}: {line}"

    def packages(self, names):
        return next((reason for reason in map(self.package, names) if reason), "")

    # Debian packages

    def debian(self, package, header):
        """As `package`, for a header of a Debian package."""
        if package not in self.problems:
            self.problems[package] = self.install_debian(package, header)
        return self.problems[package]

    @staticmethod
    def has_header(header):
        probe = subprocess.run(["g++", "-E", "-x", "c++", "-"], input=f"#include <{header}>\n", text=True,
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False)
        return probe.returncode == 0

    def install_debian(self, package, header):
        if self.has_header(header):
            return ""
        if not self.install or os.environ.get("KOKSMA_SKIP_INSTALL") == "1":
            return f"{package} is not installed, and nothing is to be installed"
        if shutil.which("apt-get") is None:
            return f"no apt-get; what Debian's {package} holds is missing"
        if os.geteuid() != 0 and shutil.which("sudo") is None:
            return f"neither root nor sudo to install {package}"
        self.say(f"installing {package}")
        apt = [] if os.geteuid() == 0 else ["sudo"]
        apt += ["env", "DEBIAN_FRONTEND=noninteractive", "apt-get", "-q", "-y", "-o", "DPkg::Lock::Timeout=300"]
        if not self.updated:
            run([*apt, "update"], 600)
            self.updated = True
        status, line = run([*apt, "install", "--no-install-recommends", package], 1200)
        return "" if status == 0 and self.has_header(header) else f"apt-get install {package}: {line}"

    def debian_version(self, package):
        status, line = run(["dpkg-query", "-W", "-f", "${Version}", package], 60)
        return line if status == 0 else ""

    # Programs and files

    def program(self, name, libraries):
        """Builds cpp/NAME.cpp; the path and "", or None and the reason."""
        source, target = HERE / "cpp" / f"{name}.cpp", self.folder / "bin" / name
        newest = max(f.stat().st_mtime for f in [source, *(HERE / "cpp").glob("*.hpp")])
        if target.exists() and target.stat().st_mtime > newest:
            return target, ""
        target.parent.mkdir(exist_ok=True)
        place = self.venv / "lib"
        found = [self.library(place, text) for text in libraries]
        command = ["g++", *FLAGS, f"-I{self.venv / 'include'}", source, "-o", target, f"-L{place}",
                   f"-Wl,-rpath,{place}", *found]
        self.say(f"building {name}")
        status, line = run(command, 300)
        return (target, "") if status == 0 else (None, f"g++ {name}.cpp: {line}")

    @staticmethod
    def library(place, text):
        """Packages of PyPI hold no unversioned links: -l:libNAME.so.* is resolved here."""
        if "*" not in text:
            return text
        found = sorted(place.glob(text.removeprefix("-l:")))
        return f"-l:{found[0].name}" if found else text

    def matrices(self):
        """The file of Sobol's generating matrices for those peers that bring none of their own."""
        path = self.folder / "sobol_matrices.txt"
        if path.exists():
            return path, ""
        code = ("import qmcpy, sys; m = qmcpy.DigitalNetB2(8, randomize=None).gen_mats[0]; "
                "open(sys.argv[1], 'w').write(''.join(' '.join(str(int(c)) for c in row) + '\\n' for row in m))")
        status, line = run([self.python, "-c", code, path], 120)
        return (path, "") if status == 0 else (None, f"generating matrices: {line}")

    def qmctoolscl_library(self):
        return next(self.venv.glob("lib/python*/site-packages/qmctoolscl/c_lib*.so"), None)
