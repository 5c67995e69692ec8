"""Whether the program says no: exit codes when something is broken, and options that change what they say they change.

judges_test.py BUILD_DIR
"""
import json
import pathlib
import signal
import subprocess
import tempfile
import time

import program
from program import delassus, end, expect, failures

FAMILY = ["--family", "chain", "--n", "4"]
DEFECT = ["--defect", "one_part_in_1e10"]


def run(*command, code=0):
    done = program.run(*command)
    expect(f"{' '.join(map(str, command))}: exit code {done.returncode}, not {code}: {done.stdout[-300:]}{done.stderr[-300:]}", done.returncode == code)
    return done.stdout


def data(*command, code=0):
    text = run(*command, code=code)
    try:
        return json.loads(text)
    except json.JSONDecodeError:
        failures.append(f"{' '.join(map(str, command))}: no JSON: {text[:200]}")
        return {}


def close(x, y, by=1e-9):
    return len(x) == len(y) and all(abs(a - b) <= by * (1 + max(abs(b), abs(a))) for a, b in zip(x, y))


def product(A, x):
    return [sum(a * b for a, b in zip(row, x)) for row in A]


def jacobian(parts):
    """Rows Σ K_i S_j over the joints j from body i to its root, and 𝒦 of rows on a joint, of an export."""
    rows = [[0.0] * parts["dof"] for _ in range(parts["rows"])]
    for constraint in parts["constraints"]:
        for r in range(constraint["rows"]):
            row = rows[constraint["row"] + r]
            if "joint_of_body" in constraint:
                first = parts["joints"][constraint["joint_of_body"]]["first_dof"]
                for k, x in enumerate(constraint["K"][r]):
                    row[first + k] += x
            for link in constraint.get("links", []):
                body = link["body"]
                while body >= 0:
                    joint = parts["joints"][body]
                    for dof in range(joint["first_dof"], joint["first_dof"] + joint["dof"]):
                        row[dof] += sum(k * s for k, s in zip(link["K"][r], parts["S"][dof]))
                    body = parts["parents"][body]
    return rows


def solved(A, B):
    """X of A X = B, by elimination with pivots."""
    n = len(A)
    rows = [list(a) + list(b) for a, b in zip(A, B)]
    for k in range(n):
        p = max(range(k, n), key=lambda r: abs(rows[r][k]))
        rows[k], rows[p] = rows[p], rows[k]
        for r in range(n):
            if r != k and rows[r][k] != 0:
                f = rows[r][k] / rows[k][k]
                rows[r] = [a - f * b for a, b in zip(rows[r], rows[k])]
    return [[a / rows[k][k] for a in rows[k][n:]] for k in range(n)]


# check: a broken law is counted, shown and said by the exit code; the others are not.
def failed(laws):
    return sum(law["failed"] for op in laws for law in op["laws"])


right = data("check", *FAMILY, "--op", "dense_cholesky", "--json")
wrong = data("check", *FAMILY, *DEFECT, "--json", code=1)
expect("check: the right operator breaks a law", failed(right) == 0)
expect("check: the wrong one breaks none", failed(wrong) > 0)
expect("check: what is broken has a ratio of 30 or more, what is not has less",
       all((law["worst_ratio"] == "infinity" or law["worst_ratio"] >= 30) == (law["failed"] > 0)
           for op in right + wrong for law in op["laws"] if law["checked"] > 0))
text = run("check", *FAMILY, *DEFECT, code=1)
expect("check: as many marks as broken laws", text.count("✗") == sum(law["failed"] > 0 for op in wrong for law in op["laws"]))
expect("check: how many failed", f"1 cases, {failed(wrong)} failed" in text)
lines = run("check", *FAMILY, *DEFECT, "--all", code=1)
expect("check --all: every law", all(law["law"] in lines for op in wrong for law in op["laws"]) and lines.count("✗") == text.count("✗"))
summary = run("check", *FAMILY, "--op", "dense_cholesky", "--op", "lcaba").split("\n")
worst_of = max((law for law in right[0]["laws"] if law["checked"]), key=lambda law: law["worst_ratio"])
expect(f"check: one line per operator: {summary}", len(summary) == 6 and [line.split()[0] for line in summary[2:4]] == ["dense_cholesky", "lcaba"]
       and summary[2].split()[1:4] == [str(sum(bool(law[key]) for law in right[0]["laws"])) for key in ("checked", "failed")]
       + [str(sum(not law["checked"] for law in right[0]["laws"]))] and worst_of["law"] in summary[2])
expect("check: a mark without a broken law", "✗" not in run("check", *FAMILY, "--op", "dense_cholesky"))


def worst(laws, name="solve = definition"):
    return [law.get("worst_ratio") for op in laws for law in op["laws"]]


expect("check --seed", worst(data("check", *FAMILY, "--op", "lcaba", "--json", "--seed", 2)) != worst(data("check", *FAMILY, "--op", "lcaba", "--json", "--seed", 3)))
expect("check --n", "5 bodies" in run("check", "--family", "chain", "--n", 5, "--op", "lcaba"))
expect("check --op", [op["name"] for op in data("check", *FAMILY, "--op", "cg", "--op", "lcaba", "--json")] == ["cg", "lcaba"])
digits = [data("check", *FAMILY, "--digits", "--json", "--damping", d) for d in (1e-2, 1e-8)]
expect("check --digits --damping", digits[0] != digits[1])

with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)

    # replay: of a failure as of a spec.
    found = data("stress", "--seed", 1, "--count", 4, "--json", "--folder", folder, *DEFECT, code=1)
    for failure in found.get("failures", []):
        run("replay", failure["file"], *DEFECT, code=1)
        run("replay", failure["file"], "--op", "dense_cholesky")
        outcomes = data("replay", failure["file"], *DEFECT, "--all", "--json", code=1)
        expect("replay: no outcome fails", any(not o["holds"] for o in outcomes if "holds" in o))
    other = data("stress", "--seed", 5, "--count", 4, "--json", "--folder", folder, *DEFECT, code=1)
    seeds = [{failure["file"] for failure in f.get("failures", [])} for f in (found, other)]
    expect("stress --seed", seeds[0] and seeds[1] and seeds[0] != seeds[1])

    # export read back is the A that apply multiplies by, and the inverse of what solve multiplies by.
    scene = "swimmer:2"
    e = data("export", scene)
    (folder / "out.json").write_text("")
    run("export", scene, "--out", folder / "out.json")
    expect("export --out", json.loads((folder / "out.json").read_text()) == e)
    J, M, R = e["J"], e["M"], e["R_inverse"]
    for name in (scene, "cassie"):  # A does not see the sign of J, its own parts do
        parts = data("export", name)
        expect(f"export {name}: J of its K and S", all(close(row, from_parts) for row, from_parts in zip(parts["J"], jacobian(parts))))
    Minv_Jt = solved(M, [list(column) for column in zip(*J)])
    A = [[sum(J[r][k] * Minv_Jt[k][c] for k in range(len(M))) + R[r][c] for c in range(len(J))] for r in range(len(J))]
    m = len(J)
    x = [((7 * i) % 11 - 5) / 10 for i in range(m)]
    (folder / "x.json").write_text(json.dumps(x))
    given = ["--input", folder / "x.json"]
    for op in ("aba_sweep", "dense_cholesky"):
        ones, of_x = (data("apply", scene, "--op", op, "--json", *more) for more in ([], given))
        expect(f"apply by {op} of ones", ones["input"] == [1] * m and close(ones["output"], product(A, [1] * m)))
        expect(f"apply by {op} --input", of_x["input"] == x and close(of_x["output"], product(A, x)))
    f = data("apply", scene, "--op", "ladder", "--solve", "--json", *given)
    expect("apply --solve", f["function"] == "solve" and close(product(A, f["output"]), x, 1e-6))
    asked = data("apply", scene, "--op", "aba_sweep", "--json", "--damping", 0.25, *given)
    undamped = [a - r for a, r in zip(product(A, x), product(R, x))]
    expect("apply --damping", close(asked["output"], [a + 0.25 * b for a, b in zip(undamped, x)]) and asked["damping"] != of_x["damping"])
    consistent = data("apply", scene, "--op", "ladder", "--solve", "--json", "--rhs", "consistent")
    expect("apply --rhs", close(consistent["input"], product(A, [1] * m)) and close(consistent["output"], [1] * m, 1e-6))
    full, fast = (data("apply", "cassie", "--op", "lcaba_refined", "--solve", "--json", "--accuracy", a)["report"] for a in ("0", "inf"))
    expect("apply --accuracy", full["error_bound"] is not None and fast["error_bound"] is None and fast["iterations"] == 0)
    text = run("apply", scene, "--op", op, *given)
    lines = [line.split(None, 5) for line in text.split("\n")[3:3 + m]]
    expect("apply prints what it computed", [[float(a), float(b)] for _, a, _, b, _, _ in lines] == [list(pair) for pair in zip(x, of_x["output"])])
    expect("apply says what the numbers are", "read from" in text.split("\n")[1]
           and all((u, v, name) == ("N", "m/s²", of_x["row_names"][k]) for k, (_, _, u, _, v, name) in enumerate(lines)))
    turning = folder / "turning.yaml"
    turning.write_text("boxes:\n  - {name: b, mass: 2, size: [1, 1, 1]}\nconstraints:\n  - {kind: weld, of: b, at: [0, 0, 0], to: world}\ngravity: [0, 0, -10]\ndamping: 0\n")
    held = data("apply", turning, "--op", "ladder", "--solve", "--json")
    expect("apply: rows that turn", held["row_units"] == [["rad/s²", "N m"]] * 3 + [["m/s²", "N"]] * 3)
    expect(f"apply: the weight of a box, 20 N: {held['output']}", close(held["input"], [0, 0, 0, 0, 0, 10]) and close(held["output"], [0, 0, 0, 0, 0, 20]) and "gravity" in held["input_is"])
    expect("apply --rhs ones", data("apply", turning, "--op", "ladder", "--solve", "--json", "--rhs", "ones")["input"] == [1] * 6)
    limp = data("apply", "go2_standing", "--op", "ladder", "--solve", "--json")
    expect("apply: what falls freely needs 9.81 m/s² along normals alone", close(limp["input"], [9.81, 0, 0] * 4) and all(f > 0 for f in limp["output"][::3]))
    run("apply", scene, "--op", "lcaba", "--solve", "--damping", 0, code=1)  # no answer

    # bench: every phase there is has a time and a count; what was not measured has none; slower or more work than before is said.
    timed = data("bench", "--scene", scene, "--op", "aba_sweep", "--op", "lcaba", "--op", "lcaba_float", "--budget", "0.001", "--json")
    cells = {c["operator"]: c for c in timed["scenes"][0]["operators"]}
    has = {"aba_sweep": {"update", "new_damping", "apply"}, "lcaba": {"update", "new_damping", "solve"}}
    for op, phases in has.items():
        c = cells[op]
        times = {phase for phase, t in c["microseconds"].items() if t is not None and 0 < t["lowest"] <= t["median"] < 1e6}
        expect(f"bench: times of {op}", times == phases | {"analyze"})
        counts = {phase for phase, n in c["operations"].items() if n is not None and (n > 0 or (op, phase) == ("aba_sweep", "new_damping"))}
        expect(f"bench: counts of {op}", counts == phases)
        expect(f"bench: bytes of {op}", c["bytes"] > 0 and c["update_status"] == "ok")
    expect("bench: lcaba_float cannot be counted", all(n is None for n in cells["lcaba_float"]["operations"].values()))

    def against(change, code, phase="update"):
        before = json.loads(json.dumps(timed))
        change(next(c for c in before["scenes"][0]["operators"] if c["operator"] == "lcaba"))
        (folder / "before.json").write_text(json.dumps(before))
        return run("bench", "--scene", scene, "--op", "lcaba", "--budget", "0.001", "--slack", 50, "--baseline", folder / "before.json", code=code)

    against(lambda c: None, 0)
    against(lambda c: c["microseconds"]["solve"].update(lowest=1e-6), 3)
    against(lambda c: c["operations"].update(solve=c["operations"]["solve"] - 1), 3)
    against(lambda c: c["operations"].update(solve=c["operations"]["solve"] + 1), 0)

    # bench --table1: no hole, the same text from the file; --compare: what changed, and exit code 3 where it is slower.
    table = data("bench", "--table1", "--scene", scene, "--op", "aba_sweep", "--op", "lcaba", "--op", "ltl_osim", "--budget", "0.002", "--json")
    entries = {e["operator"]: e for e in table["table1"][0]["operators"]}
    for op, e in entries.items():
        expect(f"table1: no hole in {op}", all(("none" in use) != ("microseconds" in use) for use in e["uses"].values()))
    expect("table1: who has what", entries["aba_sweep"]["uses"]["solve"] == {"none": "has no solve"} and "microseconds" in entries["lcaba"]["uses"]["new_damping"])
    expect("table1: errors", entries["aba_sweep"]["product_error"] < 1e-12 and entries["lcaba"]["force_error"] < 1e-6)
    before, after = folder / "table.json", folder / "slower.json"
    before.write_text(json.dumps(table))
    expect("table1 --from", scene in run("bench", "--table1", "--from", before))
    run("bench", "--table1", "--from", folder / "x.json", code=2)
    expect("compare: nothing changed", run("bench", "--compare", before, before).startswith("0 of "))
    use = entries["lcaba"]["uses"]["solve"]["microseconds"]
    use.update(median=1e6, quartiles=[1e6, 1e6])
    after.write_text(json.dumps(table))
    expect("compare: slower", f"{scene} · lcaba · solve" in run("bench", "--compare", before, after, code=3))
    run("bench", "--compare", after, before)
    swimmers = data("bench", "--swimmers", "--largest", 10, "--budget", "0.001", "--json")
    expect("swimmers", [s["links"] for s in swimmers["swimmers"]] == [3, 10] and all(len(s["operators"]) > 10 for s in swimmers["swimmers"]))
    ladders = data("bench", "--ladders", "chain", "wall", "--op", "lcaba", "--op", "efpa", "--operations", "1e6", "--json")
    expect("ladders", [l["ladder"] for l in ladders["ladders"]] == ["chain", "wall"] and [c["operator"] for c in ladders["ladders"][0]["sizes"][0]["operators"]] == ["lcaba", "efpa"])

    hard = folder / "hard.yaml"
    hard.write_text("boxes:\n  - {name: b, mass: 1, size: [1, 1, 1]}\nconstraints:\n  - {kind: point, of: b, at: [0, 0, 0], to: world}\ndamping: 0\n")
    cell = data("bench", "--scene", hard, "--op", "lcaba", "--budget", "0.001", "--json")["scenes"][0]["operators"][0]
    expect("bench: no answer is said", cell["solve_status"] == "zero_damping" and cell["update_status"] == "zero_damping")

    # accuracy: the claim is judged, the options change what is measured.
    measured = ["accuracy", "swimmer:2", "--op", "lcaba", "--op", "ladder", "--no-time", "--json"]
    run(*measured, "--damping", "1e-12")
    run(*measured, "--damping", "1e-12", "--claim", "lcaba", code=1)
    levels = {d: data(*measured, "--damping", d)[0]["levels"][0] for d in ("1e-4", "1e-6")}
    expect("accuracy --damping", [level["damping"] for level in levels.values()] == [1e-4, 1e-6])
    far, near = (data("accuracy", "swimmer:2", "--op", "lcaba, world", "--no-time", "--json", "--damping", "1e-4", "--away", d)[0] for d in ("1000000", "0"))
    motion = [t["levels"][0]["rungs"][0]["motion_error"] for t in (far, near)]
    expect("accuracy --away", far["away"] == 1e6 and motion[0] > 1e6 * motion[1])
    for option in (["--seed", "2"], ["--rhs", "random"]):
        expect(f"accuracy {option}", data(*measured, "--damping", "1e-4", *option)[0]["levels"] != [levels["1e-4"]])

    # report: what was checked, and what failed.
    out = folder / "report"
    said = run("report", "--out", out, "--scene", "go2_standing", "--op", "lcaba", "--op", "dense_cholesky", "--quick")
    results = json.loads((out / "results.json").read_text())
    checked = [law for s in results["scenes"] for c in s["operators"] for law in c.get("laws", []) if "skipped" not in law]
    expect("report: counts", results["checked"] == len(checked) > 0 and results["failed"] == 0 and all(law["passed"] for law in checked))
    expect("report: the same in words", f"{len(checked)} law checks, 0 failed" in said)
    expect("report: ratios", all(law["ratio"] != "infinity" and law["ratio"] < 30 for law in checked))
    said = run("report", "--out", out, "--scene", "go2_standing", "--quick", *DEFECT, code=1)
    results = json.loads((out / "results.json").read_text())
    broken = [law for c in results["scenes"][0]["operators"] for law in c["laws"] if not law.get("passed", True)]
    expect("report: broken laws are counted", results["failed"] == len(broken) > 0 and f", {len(broken)} failed" in said and f"{len(broken)} FAILED" in said)
    expect("report: broken laws are listed", said.count("FAILED  go2_standing") == len(broken) and "hold" not in said)
    page = (out / "index.html").read_text()
    expect("report: broken laws are on the page", f"✗ {len(broken)}<" in page and "all hold" not in page and page.count("<li><code>one_part_in_1e10 · go2_standing") == len(broken))
    said = run("report", "--out", out, "--scene", "go2_standing", "--op", "lcaba", "--quick", "--no-check")
    expect("report --no-check", "0 law checks" in said and " hold" not in said)

    # describe: the configuration and the rows by name.
    text, told = run("describe", "cassie"), data("describe", "cassie", "--json")
    moved = [j for j in told["configuration"] if any(j["q"])]
    expect("describe: q after assembly", [x for j in told["configuration"] for x in j["q"]] == data("export", "cassie")["q"]
           and all(j["joint"] in text and f"{j['q'][0]:.9g}" in text for j in moved[:20]))
    expect("describe: rows by name", all(c["name"] in text for c in told["constraints"] if c.get("name")) and "[N]" in text)

    # Ctrl-C keeps what was computed, and says so by the exit code.
    def interrupt(*command, after=1.5):
        process = subprocess.Popen([str(word) for word in (delassus, *command)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        time.sleep(after)
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=120)
        expect(f"{command[0]} after Ctrl-C: exit code {process.returncode}: {err[-200:]}", process.returncode == 130 and "interrupted" in err)
        return out

    found = json.loads(interrupt("stress", "--seed", 1, "--time", "200s", "--json", "--op", "lcaba", "--folder", folder))
    expect("stress after Ctrl-C", 0 < found["problems"] and found["seconds"] < 100)
    expect("check after Ctrl-C", "failed of" in interrupt("check"))
    expect("accuracy after Ctrl-C", json.loads(interrupt("accuracy", "--json", "--no-time", *["cassie", "g1_standing"] * 40)))
    interrupt("report", "--out", folder / "cut", "--quick", "--op", "lcaba")
    cut = json.loads((folder / "cut" / "results.json").read_text())
    expect("report after Ctrl-C", cut["interrupted"] and "all hold" not in (folder / "cut" / "index.html").read_text())

    # report --out BAD: refused before anything is measured.
    (folder / "file").write_text("")
    start = time.monotonic()
    run("report", "--out", folder / "file" / "below", code=2)
    expect("report --out BAD at once", time.monotonic() - start < 10)

end()
