"""Every `delassus simulate` of docs/examples.md, for some steps: it ends well, with residuals below what is asked, loops closed, numbers finite.

examples_test.py BUILD_DIR [SECONDS [WORD]]     simulated, instead of a few steps: long runs of the examples with this word in their line,
                                                with the memory that they took
"""
import json
import math
import pathlib
import re
import resource
import subprocess
import sys

build = pathlib.Path(sys.argv[1])
seconds = float(sys.argv[2]) if len(sys.argv) > 2 else None
root = pathlib.Path(__file__).parents[2]
page = (root / "docs/examples.md").read_text()
lines = re.findall(r"^delassus (simulate \S+.*?)\s*(?:#.*)?$", page, re.MULTILINE)
word = sys.argv[3] if len(sys.argv) > 3 else ""
failures = []


def sound(r, wanted, asked=1e-10):
    """What is wrong with the summary of a run."""
    numbers = [r["residual"], r["left"], *(r[at][of] for at in ("begin", "end") for of in ("kinetic", "potential")), *r["end"]["centre"]]
    return [what for what, wrong in {
        f"ended at step {r['steps']} of {wanted}: {r['status']}; {r['message']}": r["steps"] != wanted or r["status"] != "ok" or r["message"],
        "a number that is not finite": not all(map(math.isfinite, numbers)),
        f"residual {r['residual']} m/s": r["residual"] > asked,
        f"loops are left open by {r['left']}": r["left"] > 1e-11,
        "files of problems that were not solved": r["unsolved"]}.items() if wrong]


for line in [line for line in lines if word in line]:
    words = line.split()
    at = words.index("--duration") + 1
    words[at] = str(seconds or 0.05)
    command = [str(build / "cli/delassus"), *words, "--json"]
    done = subprocess.run(command, capture_output=True, text=True, cwd=root)
    try:
        r = json.loads(done.stdout)
    except json.JSONDecodeError:
        failures.append(f"{line}: {done.stderr[:400]}")
        continue
    asked = float(words[words.index("--residual") + 1]) if "--residual" in words else 1e-10
    wrong = sound(r, round(float(words[at]) / r["step"]), asked)
    failures += [f"{line}: {what}" for what in wrong]
    if seconds:
        energy = [r[e]["kinetic"] + r[e]["potential"] for e in ("begin", "end")]
        print(f"{line}: {r['steps']} steps, {r['seconds'] / max(1, r['steps']) * 1e6:.0f} µs a step, residual {r['residual']:.1e}, left {r['left']:.1e}, "
              f"energy {energy[0]:.6g} → {energy[1]:.6g} J, memory so far {resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss // 1024} MB; {wrong or 'sound'}", flush=True)

if len(lines) < 12:
    failures.append(f"docs/examples.md has {len(lines)} examples")
if not sound({"steps": 3, "status": "ok", "message": "", "residual": math.nan, "left": 1, "begin": {"kinetic": 0, "potential": 0}, "end": {"kinetic": 0, "potential": 0, "centre": []}, "unsolved": []}, 4)[2:]:
    failures.append("a run that is not sound passes")
print("\n".join(failures) or f"{len(lines)} examples are sound")
sys.exit(1 if failures else 0)
