"""`delassus bench --peers`: agreement and the table's shape, or what it says where no peer is compiled in.

peers_test.py BUILD_DIR PROGRAM...   names of the programs that were found
"""
import json
import pathlib
import subprocess
import sys

delassus = pathlib.Path(sys.argv[1]) / "cli/delassus"
found = sys.argv[2:]
failures = []


def expect(what, holds):
    if not holds:
        failures.append(what)


def run(*words):
    return subprocess.run([str(word) for word in (delassus, "bench", "--peers", *words)], capture_output=True, text=True, timeout=300)


if not found:
    done = run()
    expect(f"exit code {done.returncode}", done.returncode == 2 and not done.stdout)
    for word in ["no peer", "Pinocchio 4", "libmujoco-dev", "docs/peers.md"]:
        expect(f"nothing of {word}: {done.stderr}", word in done.stderr)
else:
    done = run("--scene", "go2_standing", "--scene", "cassie", "--scene", "swimmer:5", "--budget", "0.0005", "--json")
    expect(f"exit code {done.returncode}: {done.stderr}", done.returncode == 0)
    scenes = json.loads(done.stdout)["peers"]
    expect("scenes", [s["scene"] for s in scenes] == ["go2_standing", "cassie", "swimmer:5"])
    for s in scenes:
        peers = [e for e in s["entries"] if e["program"]]
        ours = {e["name"]: e for e in s["entries"] if not e["program"]}
        for program in found:
            timed = [e for e in peers if e["program"].startswith(program) and not e["cannot"]]
            expect(f"{program} on {s['scene']}", timed)
            for e in timed:
                what = f"{s['scene']} {e['name']}"
                expect(f"{what} {e['disagrees']}", not e["disagrees"])
                expect(f"{what}: M {e['M_error']}, a {e['product_error']}, λ {e['force_error']}",
                       e["M_error"] <= 2**-26 and all(e[x] is None or e[x] <= s["limits"][x] < 1e-3 for x in ["product_error", "force_error"]))
                products, solves = e["counterparts"]["product"], e["counterparts"]["solve"]
                steps = (["kinematics"] if not e["from_q"] else []) + (["first_product", "product"] if products else []) + (["first_solve", "solve", "new_damping"] if solves else [])
                expect(f"{what}: steps {list(e['microseconds'])}", sorted(e["microseconds"]) == sorted(steps) and all(t["median"] > 0 for t in e["microseconds"].values()))
                for op in [products, solves, "ladder"]:
                    expect(f"{what}: {op} was not timed beside it", not op or ours[op]["microseconds"])
    text = run("--scene", "go2_standing", "--budget", "0.0005").stdout
    for word in ["### Time of the peer over ours", "### Where the peer is faster", "#### go2_standing: 18 degrees of freedom, 12 rows", "| ladder "]:
        expect(f"text without {word}", word in text)

if failures:
    print("\n".join(failures))
    sys.exit(1)
print("bench --peers:", ", ".join(found) or "none found, and it says so")
