"""Command lines that cannot be right: exit code 2, and a message that names the option, the value, what is accepted and what
to do.

usage_test.py BUILD_DIR
"""
import json
import pathlib
import re
import subprocess
import sys
import tempfile

build = pathlib.Path(sys.argv[1])
delassus, tests = build / "cli/delassus", build / "property_tests"
programs = ["accuracy_ladder", "certificate", "defects", "exact_dozen", "hard_cases", "paper_lines", "prime_field"]
failures = []


def run(*command):
    return subprocess.run([str(word) for word in command], capture_output=True, text=True, timeout=60)


def refused(command, *words):
    """Exit code 2, nothing on standard output, every word in the message, and `(accepted: what; what to do)`."""
    done = run(*command)
    missing = [word for word in words if word not in done.stderr]
    if not re.search(r"\(accepted: .+; .+\)", done.stderr, re.DOTALL):
        missing.append("(accepted: what; what to do)")
    if done.returncode != 2 or done.stdout or missing:
        failures.append(f"{' '.join(map(str, command[1:]))}: exit code {done.returncode}, without {missing}: {done.stderr}{done.stdout[:200]}")


def misspelt(command, *words):
    """A word that the parser of command lines does not know."""
    done = run(*command)
    missing = [word for word in words if word not in done.stderr]
    if done.returncode != 2 or done.stdout or missing:
        failures.append(f"{' '.join(map(str, command[1:]))}: exit code {done.returncode}, without {missing}: {done.stderr}")


def printed(command, *words, code=0):
    done = run(*command)
    missing = [word for word in words if word not in done.stdout]
    if done.returncode != code or missing:
        failures.append(f"{' '.join(map(str, command[1:]))}: exit code {done.returncode}, without {missing}: {done.stdout[:400]}{done.stderr}")
    return done.stdout


for n in ["0", "-1", "2.5", "ring", "99999999999999999999"]:
    refused([delassus, "check", "--family", "ring", "--n", n], "--n", f"'{n}'", "a whole number from 1")
for x in ["abc", "-1", "inf", "nan", "1e-8kg"]:
    refused([delassus, "check", "cassie", "--digits", "--damping", x], "--damping", f"'{x}'", "a finite number ≥ 0 [1/kg]")
refused([delassus, "check", "--family", "huge_numbers", "--n", "308"], "10^±308 kg", "0 to 307")
refused([delassus, "stress", "--seed", "-1"], "--seed", "'-1'", "a whole number from 0")
refused([delassus, "stress", "--time", "5x"], "--time", "'5x'", "a number of seconds > 0", "10m")
for time in ["0", "-1s", "1e999", "1e300h", "nan", ""]:
    refused([delassus, "stress", "--time", time], "--time", f"'{time}'", "a number of seconds > 0")
refused([delassus, "bench", "--budget", "0"], "--budget", "'0'", "a finite number > 0 [s]")
misspelt([delassus, "bench", "--table1", "--swimmers"], "--swimmers", "--table1")
misspelt([delassus, "bench", "--peers", "--table1"], "--peers", "--table1")
refused([delassus, "bench", "--peers", "--from", "/nowhere/peers.json"], "/nowhere/peers.json", "cannot be read", "--peers --json")
misspelt([delassus, "bench", "--simulation", "--peers"], "--simulation", "--peers")
refused([delassus, "bench", "--simulation", "--from", "/nowhere/speed.json"], "/nowhere/speed.json", "cannot be read", "--simulation --json")
refused([delassus, "bench", "--table1", "--from", "/nowhere/table1.json"], "/nowhere/table1.json", "cannot be read", "--table1 --json")
refused([delassus, "bench", "--table1", "--scene", "swimmer:1", "--cache-lines", "/nowhere/phase_probe"], "/nowhere/phase_probe")
refused([delassus, "bench", "--solvers", "--from", "/nowhere/solvers.json"], "/nowhere/solvers.json", "cannot be read", "--solvers --json")
refused([delassus, "bench", "--solvers", "--problems", "/nowhere"], "/nowhere", "cannot be read", "*.dat")
refused([delassus, "bench", "--solvers", "--solver", "pgss"], "\"pgss\"", "pgs")
refused([delassus, "bench", "--pictures", "/tmp"], "--pictures", "--swimmers, --ladders or --solvers")
refused([delassus, "bench", "--ladders", "chian"], "\"chian\"", "chain")
refused([delassus, "bench", "--ladders", "--from", "/nowhere/ladders.json"], "/nowhere/ladders.json", "cannot be read", "--ladders --json")
misspelt([delassus, "bench", "--table1", "--solvers"], "--solvers", "--table1")
refused([delassus, "bench", "--compare", "/nowhere/a.json"], "1 files", "two: before and after")
for program in programs:
    printed([tests / program, "--help"], "Exit code 1", "--help")
    misspelt([tests / program, "--nosuch"], "--nosuch", "--help")
refused([tests / "certificate", "--count", "abc"], "--count", "'abc'", "a whole number from 1")
refused([tests / "certificate", "--shard", "3/2"], "--shard", "'3/2'", "i/n with 1 ≤ i ≤ n")
refused([tests / "certificate", "--divide", "0"], "--divide", "'0'", "a finite number > 0")
refused([tests / "hard_cases", "--family", "nosuch"], "nosuch", "stiffest")
refused([tests / "defects", "nosuch"], "nosuch", "one_part_in_1e10")

# Numbers that are none, each with its reason; names that are nearly right.
for x, advice in {"1e999": "exponent", "nan": "the number meant", "1,5": "decimal point", "1kg": "the number alone", "abc": "digits", "-1": "default"}.items():
    refused([delassus, "apply", "cassie", "--op", "lcaba", "--damping", x], "--damping", f"'{x}'", "≥ 0 [1/kg]", advice)
    refused([delassus, "apply", "cassie", "--op", "lcaba", "--solve", "--accuracy", x], "--accuracy", f"'{x}'", "≥ 0, or inf", advice)
refused([delassus, "accuracy", "cassie", "--away", "1e999"], "--away", "'1e999'", "[m]", "exponent")
refused([delassus, "check", "cassie", "--op", "lcabaa"], "\"lcabaa\"", "did you mean lcaba?", "list operators")
refused([delassus, "check", "--family", "rign"], "\"rign\"", "did you mean ring?", "list families")
refused([delassus, "check", "--family", "ring", "--defect", "one_part_in_1e11"], "did you mean one_part_in_1e10?", "list defects")
refused([delassus, "accuracy", "cassie", "--op", "lcabaa"], "\"lcabaa\"", "did you mean lcaba?")
refused([delassus, "list", "operatos"], "'operatos'", "did you mean operators?")
refused([delassus, "apply", "cassie", "--op", "lcaba", "--rhs", "one"], "'one'", "did you mean ones?")
refused([delassus, "desribe", "cassie"], "\"desribe\"", "did you mean describe?", "--help")
refused([delassus, "describe", "casie"], "\"casie\"", "did you mean cassie?")
refused([delassus, "apply", "cassie", "--op", "aba_sweep", "--solve"], "--op aba_sweep", "has no solve", "lcaba")
# What would not fit into the machine is said, not tried: describing a long chain once took twenty gigabytes.
printed([delassus, "describe", "swimmer:20000"], "dense_cholesky     at least 118 GB", "ltl_osim           at least 115 GB", "lcaba                 36")
misspelt([delassus, "describe", "cassie", "--strickt"], "--strickt", "did you mean --strict?", "--help")
misspelt([delassus, "apply", "cassie", "--op", "lcaba", "--dampin=1"], "--dampin", "did you mean --damping?", "--help")

refused([delassus, "survey", "/no/such/folder"], "/no/such/folder", "a folder with robots")
with tempfile.TemporaryDirectory() as folder:
    refused([delassus, "survey", folder], folder, "holds no robot")
    robots = pathlib.Path(__file__).parents[2] / "models/robots"
    (pathlib.Path(folder) / "a.urdf").write_text((robots / "go2.urdf").read_text())
    (pathlib.Path(folder) / "b.urdf").write_text("<robot name='r'><link name='l'>")
    (pathlib.Path(folder) / "c.urdf").write_text("<!-- nothing -->")
    totals = json.loads(printed([delassus, "survey", folder, "--json"]))["totals"]
    if (totals["loads"], totals["refused_rightly"], totals["differ"]) != (1, 2, 0) or not 0 < totals["worst_ratios"]["M"] < 30:
        failures.append(f"survey: {totals}")
    (pathlib.Path(folder) / "d.sdf").write_text("<sdf version='1.9'><model name='m'><link name='a'/><link name='b'><pose>1 0 0 0 0 0</pose></link><joint name='j' type='revolute'>"
                                                "<parent>a</parent><child>b</child><axis><xyz>0 0 1</xyz></axis></joint></model></sdf>")
    (pathlib.Path(folder) / "e.xml").write_text("<mujoco><worldbody><body name='a'><joint/><geom size='1'/></body></worldbody></mujoco>")
    (pathlib.Path(folder) / "f.xml").write_text("<mujoco><worldbody><bdy/></worldbody></mujoco>")
    for j in json.loads(printed([delassus, "survey", folder, "--json"]))["files"]:
        if "differs" in j or (j["state"] == "loads" and "M" not in j["ratios"]) or (j["state"] == "refused" and j["right"] is None and "built without" not in j["why"]):
            failures.append(f"survey: {j}")
    printed([delassus, "survey", folder], "6 files", "refused, rightly", "urdfdom does not read it")

with tempfile.TemporaryDirectory() as folder:
    vector = pathlib.Path(folder) / "vector.json"
    for text, words in {"[1, 2, NaN, 4]": ["entry 2", "'NaN'"], "[1, 2": ["entry 1", "ends too early"],
                        "[1, null]": ["entries"], "{}": ["object"], "[1, 1e999, 3]": ["entry 1", "1e999 is not a finite number"],
                        "[-1e999": ["entry 0", "-1e999 is not a finite number"]}.items():
        vector.write_text(text)
        refused([delassus, "apply", "swimmer:2", "--op", "lcaba", "--solve", "--input", vector], str(vector), "finite numbers", *words)
    vector.write_text('{"scenes": 1e999}')
    refused([delassus, "bench", "--scene", "swimmer:1", "--op", "lcaba", "--baseline", vector], str(vector), "beyond double")
    refused([delassus, "stress", "--merge", vector], str(vector), "beyond double")
    refused([delassus, "replay", vector], str(vector), "1e999")
    found = json.loads(printed([delassus, "stress", "--seed", "1", "--count", "2", "--json", "--folder", folder]))
    if found["problems"] != 2 or found["failures"]:
        failures.append(f"stress --json: {found}")
    found = json.loads(printed([delassus, "stress", "--seed", "1", "--count", "4", "--json", "--folder", folder, "--defect", "one_part_in_1e10"], code=1))
    if not pathlib.Path(found["failures"][0]["file"]).is_file():
        failures.append("stress --json --defect: no file of the failure")

    # A robot's file is a scene; what is doubtful in it is told on both ways out, and an error with --strict.
    robot = pathlib.Path(folder) / "arm.urdf"
    robot.write_text("""<robot name="arm"><link name="world"/><link name="b"><inertial><origin xyz="0 0 -0.5"/><mass value="2"/>
      <inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial></link><link name="c"/>
      <joint name="j" type="revolute"><parent link="world"/><child link="b"/><axis xyz="0 1 0"/><limit lower="-1" upper="2" effort="1" velocity="1"/></joint>
      <joint name="k" type="continuous"><parent link="b"/><child link="c"/><mimic joint="j" multiplier="-2"/></joint></robot>""")
    with_armature = [robot, "--armature", "0.5"]
    text = printed([delassus, "describe", *with_armature], "fixed base, 2 dofs", "2 kg", "revolute     -1.0 … 2.0", "follows -2.0 · j", "massless: arm/c", "the base is fixed")
    for command in (["describe"], ["export"], ["apply", "--op", "lcaba", "--solve", "--damping", "1"], ["bench", "--budget", "0.001", "--op", "lcaba"],
                    ["check", "--op", "lcaba"], ["accuracy", "--damping", "1e-4", "--no-time", "--op", "lcaba"]):
        subject = ["--scene", *with_armature] if command[0] in ("bench", "check") else with_armature
        if command[0] == "accuracy":  # its options with lists would take the subject
            command, subject = ["accuracy"], [*with_armature, "--damping", "1e-4", "--op", "lcaba", "--no-time"]
        extra = [] if command[0] == "export" else ["--json"]
        done = run(delassus, *command, *subject, *extra)
        if "warning: " not in done.stderr or "1 warning; --strict makes them errors" not in done.stderr or '"kind":"point mass"' not in done.stdout.replace('": "', '":"'):
            failures.append(f"{command}: no warning: {done.stderr}{done.stdout[:300]}")
        refused([delassus, *command, *subject, *extra, "--strict"], "arm.urdf", "link \"b\"", "strict mode")
    refused([delassus, "describe", robot], "arm/c", "massless", "arm/k", "armature")
    if json.loads(run(delassus, "export", *with_armature, "--base", "fixed").stdout)["dof"] != 2:
        failures.append("export --base fixed: not 2 degrees of freedom")
    refused([delassus, "export", *with_armature, "--base", "free"], "arm/world", "M is singular")  # a point mass and a rotor alone float
    refused([delassus, "describe", "cassie", "--base", "fixed"], "--base", "\"cassie\"", "robot's file")
    refused([delassus, "describe", robot, "--base", "flying"], "--base", "flying")
    refused([delassus, "describe", robot, "--armature", "1e999"], "--armature", "1e999")
    robot.write_text("<?xml version=\"1.0\"?>")
    refused([delassus, "describe", robot], str(robot), "no element")

printed([delassus, "check", "--family", "heavy_base", "--n", "6", "--digits", "--damping", "1e-16"], "WARNING: in double lcaba refuses", "lost_pivot")
if "WARNING" in printed([delassus, "check", "cassie", "--digits", "--damping", "1e-4"]):
    failures.append("check --digits warns of a problem that lcaba solves")
printed([delassus, "list", "effects"], "gravity", "armature")
printed([delassus, "list", "solvers", "--json"], "newton_convex", "exact Coulomb")
printed([delassus, "list", "integrators"], "sdirk4", "L-stable")


# A scene that moves.
hammer = pathlib.Path(__file__).parents[2] / "docs/hammer.yaml"
printed([delassus, "simulate", hammer, "--duration", "0.02"], "20 steps of 0.001 s", "drift", "residual")
printed([delassus, "simulate", hammer, "--explain", "--markdown"], "| contacts | detection, rows |", "| **a step** |")
misspelt([delassus, "simulate", hammer, "--markdown"], "--markdown", "--explain")
printed([delassus, "simulate", hammer, "--explain"], "hammer.yaml:2", "no joint has armature", "path cones", "islands with rows")
printed([delassus, "simulate", hammer, "--explain", "--without", "contacts"], "left out", "nothing to act on without contacts", "path equations")
refused([delassus, "simulate", hammer, "--without", "contact"], "contact", "did you mean contacts?")
moving = pathlib.Path(__file__).parents[2] / "docs/moving"
printed([delassus, "simulate", moving / "racket.yaml", "--accuracy", "1e-8"], "steps taken", "rejected", "of 1e-08 a second")
printed([delassus, "simulate", moving / "swing.yaml", "--accuracy", "1e-6", "--duration", "0.2"], "steps taken", "drift")
refused([delassus, "simulate", moving / "slide.yaml", "--accuracy", "1e-8"], "contacts, contact friction", "without an accuracy")
refused([delassus, "simulate", moving / "racket.yaml", "--accuracy", "0"], "--accuracy", "'0'")
printed([delassus, "simulate", moving / "racket.yaml", "--integrator", "sdirk4", "--duration", "0.1s"], "iterations a step", "energy")
refused([delassus, "simulate", moving / "racket.yaml", "--accuracy", "1e-8", "--integrator", "euler"], "steps of one length", "dormand_prince")
short = ["--duration", "0.125", "--step", "0.015625", "--halvings", "2", "--no-time"]
printed([delassus, "accuracy", moving / "racket.yaml", "--simulate", *short], "reference by dormand_prince", "euler, order 1", "runge_kutta, order 4", "dormand_prince, controlled")
printed([delassus, "accuracy", moving / "slide.yaml", "--simulate", *short, "--solver", "proximal"], "relaxed law", "m, ", "order 1", "which are brought by: contacts, contact friction")
for words in (["--damping", "1e-4"], ["--steps"], ["--away", "1"], ["--n", "3"], ["--out", "x"]):
    misspelt([delassus, "accuracy", moving / "racket.yaml", "--simulate", *words], words[0], "--simulate")
misspelt([delassus, "accuracy", "cassie", "--halvings", "3"], "--simulate")
refused([delassus, "accuracy", "chain", "--simulate"], "chain", "does not move")
refused([delassus, "accuracy", moving / "racket.yaml", "--simulate", "--halvings", "13"], "13", "1 to 12")
refused([delassus, "accuracy", moving / "racket.yaml", "--simulate", "--duration", "0.1", "--step", "0.03"], "--duration", "whole number")
refused([delassus, "accuracy", moving / "racket.yaml", "--simulate", "--picture", "none/there.svg"], "--picture", "cannot be written")
refused([delassus, "simulate", hammer, "--step", "0"], "--step", "0")
refused([delassus, "simulate", hammer, "--solver", "newton"], "newton")
with tempfile.TemporaryDirectory() as folder:
    files = [str(pathlib.Path(folder) / name) for name in ("a.csv", "b.csv", "run.html")]
    for file in files:
        printed([delassus, "simulate", hammer, "--duration", "0.05", "--record", file], "50 steps")
    if pathlib.Path(files[0]).read_bytes() != pathlib.Path(files[1]).read_bytes():
        failures.append("simulate: two runs of one scene differ")
    if len(pathlib.Path(files[0]).read_text().splitlines()) != 52:
        failures.append("simulate --record: not a line for the start and each of 50 steps")
    page = pathlib.Path(files[2]).read_text()
    if "http" in page or '"frames":[' not in page:
        failures.append("simulate --record run.html: no recording in it, or it names something elsewhere")
    if ",islands," not in pathlib.Path(files[0]).read_text().splitlines()[0]:
        failures.append("simulate --record: no column of islands")
    kept = pathlib.Path(folder) / "problems"
    printed([delassus, "simulate", hammer, "--duration", "0.02", "--every", "10", "--capture", str(kept)], "20 steps", "captured")
    if not list(kept.glob("hammer_step_20_*.dat")) or list(kept.glob("hammer_step_1_*.dat")) or list(kept.glob("*unsolved*")):
        failures.append(f"simulate --capture: {sorted(f.name for f in kept.iterdir())}")
    done = run(delassus, "simulate", hammer, "--duration", "0.02", "--residual", "0", "--solver", "pgs", "--capture", str(kept))
    if done.returncode != 1 or "_unsolved.dat: the problem that no solver could do" not in done.stdout or len(list(kept.glob("*unsolved.dat"))) != 1:
        failures.append(f"simulate: no file of the problem that was not solved: {done.returncode} {done.stdout}")
    refused([delassus, "simulate", hammer, "--duration", "0.01", "--capture", files[0]], "--capture", "is no folder")
    refused([delassus, "simulate", hammer, "--duration", "0.01", "--record", str(pathlib.Path(folder) / "none" / "a.csv")], "--record", "cannot be written")

for script in sorted((pathlib.Path(__file__).parents[2] / "scripts").iterdir()):
    if not script.suffix:
        printed([script, "--help"], f"scripts/{script.name}" if script.name != "setup" else "packages")

print("\n".join(failures) or "every command line is refused with its reason")
sys.exit(1 if failures else 0)
