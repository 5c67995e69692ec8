"""What `delassus apply --solve` says where rows are hard, and where M is singular.

apply_test.py BUILD_DIR
"""
import json
import pathlib
import tempfile

import program
from program import EPS, end, expect


def text(*command):
    return program.run("apply", *command).stdout


def solved(*command):
    return json.loads(text(*command, "--solve", "--json"))


def link(name, mass=None, com=(0, 0, 0), inertia=()):
    if mass is None:
        return f'<link name="{name}"/>'
    i = "".join(f' i{axes}="{value}"' for axes, value in zip(("xx", "yy", "zz"), inertia)) + ' ixy="0" ixz="0" iyz="0"'
    return f'<link name="{name}"><inertial><origin xyz="{com[0]} {com[1]} {com[2]}"/><mass value="{mass}"/><inertia{i}/></inertial></link>'


def joint(name, parent, child, origin, axis):
    return (f'<joint name="{name}" type="revolute"><origin xyz="{origin}"/><parent link="{parent}"/><child link="{child}"/>'
            f'<axis xyz="{axis}"/><limit lower="-9" upper="9" effort="1" velocity="1"/></joint>')


# Six joints, the last three axes meeting along x when j5 = 0: the wrist singularity, home pose of most arms.
ARM = "<robot name='r'>" + "".join([
    link("base", 1, (0, 0, 0), (0.1, 0.1, 0.1)),
    link("l1", 4, (0.02, 0, 0.1), (0.08, 0.096, 0.072)), link("l2", 6, (0, 0.01, 0.25), (0.12, 0.144, 0.108)),
    link("l3", 3, (0.1, 0, 0.03), (0.06, 0.072, 0.054)), link("l4", 2, (0.15, 0.01, 0), (0.04, 0.048, 0.036)),
    link("l5", 1, (0.02, 0, 0.01), (0.02, 0.024, 0.018)), link("l6", 0.4, (0.03, 0.01, 0.02), (0.008, 0.0096, 0.0072)),
    joint("j1", "base", "l1", "0 0 0.4", "0 0 1"), joint("j2", "l1", "l2", "0.05 0 0.3", "0 1 0"),
    joint("j3", "l2", "l3", "0 0 0.5", "0 1 0"), joint("j4", "l3", "l4", "0.2 0 0", "1 0 0"),
    joint("j5", "l4", "l5", "0.3 0 0", "0 1 0"), joint("j6", "l5", "l6", "0.1 0 0", "1 0 0")]) + "</robot>"

# Three axes through one point, the first and the third parallel, nothing but the last link with a mass.
GIMBAL = "<robot name='r'>" + "".join([
    link("base", 1, (0, 0, 0), (0.1, 0.1, 0.1)), link("d1"), link("d2"), link("b", 2, (0.1, 0.2, 0.3), (0.1, 0.1, 0.1)),
    joint("jx", "base", "d1", "0 0 0", "0 0 1"), joint("jy", "d1", "d2", "0 0 0", "0 1 0"),
    joint("jz", "d2", "b", "0 0 0", "0 0 1")]) + "</robot>"

with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    (folder / "arm.urdf").write_text(ARM)
    (folder / "gimbal.urdf").write_text(GIMBAL)
    (folder / "a.json").write_text("[0.3, -0.2, 0.5, 0.1, -0.7, 0.4]")

    def wrist(j5):
        scene = folder / f"wrist_{j5}.yaml"
        scene.write_text("robots:\n  - {name: r, urdf: arm.urdf, base: fixed, joints: "
                         f"{{j1: 0.3, j2: 0.4, j3: -0.5, j4: 0.6, j5: {j5}, j6: -0.2}}}}\n"
                         "constraints:\n  - {kind: weld, of: r/l6, at: [0.05, 0, 0], to: world}\n")
        return scene

    hard = ["--op", "ladder", "--damping", 0]
    at = solved(wrist("0"), *hard, "--input", folder / "a.json")
    expect("wrist: inconsistent", at["report"]["status"] == "inconsistent")
    expect("wrist: row 4 named", at["dependent_rows"] == [4] and at["report"]["where"] == 4)
    expect("wrist: the row in words", at["dependent_row_names"] == ["weld r/l6 - world, row 5 of 6"])
    expect("wrist: no numbers", all(x is None for x in at["output"]))
    words = text(wrist("0"), *hard, "--solve", "--input", folder / "a.json")
    expect("wrist in words", "status inconsistent at row 4 (weld r/l6 - world, row 5 of 6)" in words
           and "1 of 6 rows are hard and depend on the others" in words)

    near, best = (solved(wrist("1e-7"), "--op", op, "--damping", 0, "--input", folder / "a.json") for op in ("ladder", "kkt_elimination"))
    expect("near the wrist: the best answer", near["report"]["rung"] == "kkt_elimination" and near["output"] == best["output"])
    expect("near the wrist: its size", 1.2e13 < max(abs(x) for x in near["output"]) < 1.22e13)
    expect("near the wrist: no row left out", near["dependent_rows"] == [])

    gimbal = folder / "gimbal.yaml"
    gimbal.write_text("robots:\n  - {name: r, urdf: gimbal.urdf, base: fixed}\n"
                      "constraints:\n  - {kind: point, of: r/b, at: [0.3, -0.2, 0.1], to: world}\n")
    for op in ("ladder", "lcaba", "dense_cholesky", "kkt_elimination"):
        lost = text(gimbal, "--op", op, "--solve", "--damping", 1e-6)
        expect(f"gimbal lock by {op}", "status lost_pivot at joint r/jx (M is singular at this pose" in lost)

consistent = solved("cassie", *hard, "--rhs", "consistent")
expect("cassie: ok", consistent["report"]["status"] == "ok" and 0 <= consistent["report"]["error_bound"] < 30 * EPS)
expect("cassie: 4 of 24 rows", len(consistent["dependent_rows"]) == 4 and consistent["rows"] == 24)
expect("cassie: ones contradict", solved("cassie", *hard, "--rhs", "ones")["report"]["status"] == "inconsistent")

# Stiff and redundant: all digits are there, and the status says so.
with tempfile.TemporaryDirectory() as name:
    vector = pathlib.Path(name) / "vector.json"
    vector.write_text(json.dumps([((7 * i) % 11 - 5) / 10 for i in range(24)]))
    a = json.loads(text("cassie", "--op", "aba_sweep", "--damping", 0, "--input", vector, "--json"))["output"]
    vector.write_text(json.dumps(a))
    for damping in (1e-8, 1e-12, 1e-14, 1e-16, 1e-18):
        said = solved("cassie", "--op", "ladder", "--damping", damping, "--input", vector)["report"]
        expect(f"cassie at {damping}: {said}", said["status"] == "ok" and said["error_bound"] < 30 * EPS)

end()
