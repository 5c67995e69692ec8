"""The program delassus, and what was expected of it: what the tests of this folder share. Their first word is the build directory."""
import pathlib
import subprocess
import sys

EPS = 2.0**-53

delassus = pathlib.Path(sys.argv[1]) / "cli/delassus"
failures = []


def expect(what, holds):
    if not holds:
        failures.append(what)


def run(*command):
    return subprocess.run([str(word) for word in (delassus, *command)], capture_output=True, text=True, timeout=240)


def end():
    for failure in failures:
        print("FAILED", failure)
    print(f"{len(failures)} failed")
    sys.exit(1 if failures else 0)
