"""What `delassus dynamics` says of a pendulum that can be done by hand.

dynamics_test.py BUILD_DIR
"""
import json
import pathlib
import tempfile

import program
from program import EPS, end, expect


def near(x, y):
    return abs(x - y) < 30 * EPS * max(abs(y), 1)


def run(*command):
    return program.run("dynamics", *command)


# 2 kg at 0.5 m along x on an axis along y, 0.1 kg m² about its centre: M = 0.6 kg m², weight −10 N m at g = 10 m/s².
ROBOT = ('<robot name="p"><link name="base"/><link name="l"><inertial><origin xyz="0.5 0 0"/><mass value="2"/>'
         '<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>'
         '<joint name="j" type="continuous"><parent link="base"/><child link="l"/><axis xyz="0 1 0"/></joint></robot>')
SCENE = "gravity: [0, 0, -10]\nrobots:\n  - {name: p, urdf: p.urdf, base: fixed}\n"
POINT = "constraints:\n  - {kind: point, of: p/l, at: [1, 0, 0], to: world}\n"

with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    (folder / "p.urdf").write_text(ROBOT)
    (folder / "free.yaml").write_text(SCENE)
    (folder / "held.yaml").write_text(SCENE + POINT)
    (folder / "3.json").write_text("[3]")
    (folder / "two.json").write_text("[1, 2]")
    (folder / "rows.json").write_text("[0, 0, 3]")
    (folder / "along.json").write_text("[1, 0, 0]")

    free = json.loads(run(folder / "free.yaml", "--json").stdout)
    expect("weight", near(free["bias_forces"][0], -10) and free["gravity"] == [0, 0, -10])
    expect("fall", near(free["acceleration"][0], 10 / 0.6) and free["free_acceleration"] == free["acceleration"])
    pushed = json.loads(run(folder / "free.yaml", "--torque", folder / "3.json", "--velocity", folder / "3.json", "--json").stdout)
    expect("torque", near(pushed["acceleration"][0], 13 / 0.6) and near(pushed["bias_forces"][0], -10))

    # Rows are minus the motion of the tip or the tip itself: the sign of J is that of its one row that is not zero.
    held = json.loads(run(folder / "held.yaml", "--damping", 0, "--json").stdout)
    expect("held: stands", near(held["acceleration"][0], 0) and near(held["free_acceleration"][0], 10 / 0.6))
    expect("held: 10 N on a lever of 1 m", near(abs(held["lambda"][2]), 10) and held["lambda"][:2] == [0, 0])
    expect("held: exit code", run(folder / "held.yaml", "--damping", 0).returncode == 0)
    moved = json.loads(run(folder / "held.yaml", "--damping", 0, "--acceleration", folder / "rows.json", "--json").stdout)
    expect("held: as wanted", near(abs(moved["acceleration"][0]), 3))
    # Rows in the axes of the link that turns: J is constant.
    turning = json.loads(run(folder / "held.yaml", "--damping", 0, "--velocity", folder / "3.json", "--json").stdout)
    expect("turning: J-dot nu", all(near(x, 0) for x in turning["bias_rows"]) and turning["velocity"] == [3])
    # The tip cannot accelerate along the link.
    along = run(folder / "held.yaml", "--damping", 0, "--acceleration", folder / "along.json", "--json")
    expect("along: inconsistent", json.loads(along.stdout)["report"]["status"] == "inconsistent" and along.returncode == 1)
    words = run(folder / "held.yaml", "--damping", 0).stdout
    expect("words", "p/j" in words and "gravity (0, 0, -10) m/s²" in words and "status ok" in words)
    wrong = run(folder / "free.yaml", "--velocity", folder / "two.json")
    expect("wrong length", wrong.returncode == 2 and "two.json" in wrong.stderr)
    wrong = run(folder / "free.yaml", "--op", "laddr")
    expect("wrong operator", wrong.returncode == 2 and "did you mean ladder" in wrong.stderr)

end()
