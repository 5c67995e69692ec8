#!/usr/bin/env python3
"""Faults seeded by hand in what judges (command line, benches, laws' loop, references, generators): which test notices which.

    property_tests/mutation/judge_faults.py --work DIR [--files cli/check.cpp ...] [--jobs N]

Takes the entries of seeded_faults.txt whose file stands with its folder; the others are mutate.py's. Every fault is built alone,
in a copy of the last commit in DIR. Exit code 0: every fault was noticed; 1: not; 2: the tests fail without a fault.
"""
import argparse
import os
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, HERE)
import mutate  # noqa: E402

PYTHON = [sys.executable, "property_tests/command_line/judges_test.py", "build/release"]
UNIT = ["build/release/property_tests/unit_tests", "--gtest_brief=1", "--gtest_filter=Judges.*:Verdict.*:WrongDamping.*:Misuse.*:Where.*:damping.*:Reference*:Sensitivity.*:Generators.*:Spectrum.*"]
BENCH = ["build/release/property_tests/bench_judges", "--gtest_brief=1"]
# By folder: targets, and (test, its command, whether it must fail).
TESTS = {
    "cli": (["delassus_program"], [("judges", PYTHON, False)]),
    "bench": (["bench_judges", "delassus_program", "work_gate", "scaling_gate"],
              [("bench_judges", BENCH, False), ("judges", PYTHON, False), ("work_gate_can_fail", ["build/release/bench/work_gate", "dense_cholesky", "320"], True),
               ("scaling_gate_can_fail.cubic_form", ["build/release/bench/scaling_gate", "--defect", "cubic_form"], True)]),
    "property_tests": (["property_tests", "unit_tests"],
                       [("laws_can_fail", ["build/release/property_tests/property_tests", "--defect", "one_part_in_1e10", "--family", "chain", "--seeds", "1"], True),
                        ("unit", UNIT, False)]),
    "reference": (["unit_tests"], [("unit", UNIT, False)]),
    "generators": (["unit_tests"], [("unit", UNIT, False)]),
    "algorithms": (["unit_tests"], [("unit", UNIT, False)]),
}


def noticed(tree, folder, jobs):
    """The test that notices, or nothing; "compiler" when it is not built."""
    targets, tests = TESTS[folder]
    if subprocess.run(["ninja", "-C", "build/release", "-j%d" % jobs, *targets], cwd=tree, stdout=subprocess.DEVNULL).returncode:
        return "compiler"
    for name, command, must_fail in tests:
        try:
            done = subprocess.run(command, cwd=tree, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=600, errors="replace")
        except subprocess.TimeoutExpired:
            return name + " (time)"
        if (done.returncode == 0) == must_fail:
            said = next((line for line in done.stdout.split("\n") if line.startswith("FAILED ") or "[  FAILED  ]" in line), "")
            return "%s: %s" % (name, said.replace("[  FAILED  ]", "").strip()[:100])
    return ""


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--work", required=True)
    p.add_argument("--files", nargs="+")
    p.add_argument("--jobs", type=int, default=1)
    options = p.parse_args()
    faults = [(pair, kind) for pair, kind in mutate.read_equivalent(os.path.join(HERE, "seeded_faults.txt")).items() if "/" in pair[0]]
    faults = [f for f in faults if not options.files or f[0][0] in options.files]
    tree = os.path.join(options.work, "tree")
    os.makedirs(tree, exist_ok=True)
    archive = subprocess.run(["git", "-C", mutate.ROOT, "archive", "HEAD"], stdout=subprocess.PIPE, check=True).stdout
    # with the time of now: what the last run left built is of its last fault
    subprocess.run(["tar", "-xm", "-C", tree], input=archive, check=True)
    subprocess.run(["cmake", "--preset", "release", "-DDELASSUS_UNITY=ON"], cwd=tree, check=True, stdout=subprocess.DEVNULL)
    for folder in sorted({name.split("/")[0] for (name, _, _), _ in faults}):
        if by := noticed(tree, folder, options.jobs):
            print("without a fault:", folder, by)
            sys.exit(2)
    missed = 0
    print("| kind | source | noticed by |\n|---|---|---|")
    for (name, before, after), kind in faults:
        path = os.path.join(tree, name)
        text = open(path, encoding="utf-8").read()
        lines = text.split("\n")
        places = [k for k, line in enumerate(lines) if line.strip() == before]
        if len(places) != 1:
            sys.exit("judge_faults.py: %d lines of %s read: %s" % (len(places), name, before))
        line = lines[places[0]]
        lines[places[0]] = line[:len(line) - len(line.lstrip())] + after
        open(path, "w", encoding="utf-8").write("\n".join(lines))
        by = noticed(tree, name.split("/")[0], options.jobs)
        open(path, "w", encoding="utf-8").write(text)
        missed += by in ("", "compiler")
        print("| %s | `%s` | %s |" % (kind, name, by or "**nobody**"), flush=True)
    sys.exit(1 if missed else 0)


if __name__ == "__main__":
    main()
