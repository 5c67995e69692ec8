#!/usr/bin/env python3
"""Mutation testing of the sources of the operators and of the way in: one change at a time (mutations.py) in a copy of a
commit, which the program mutant_killer (operators) or models_killer (the way in) must notice.

    property_tests/mutation/mutate.py --work DIR [--files factor.cpp sweep.cpp ...] [--sample N --seed S] [--batch N]
                             [--json FILE [--resume | --again]] [--list]
    property_tests/mutation/mutate.py --table --json FILE
    property_tests/mutation/mutate.py --check                    are the lines of mutants_equivalent.txt and seeded_faults.txt still there?
    property_tests/mutation/mutate.py --work DIR --files ... --faults FILE     faults seeded by hand: kind, file, and the test that notices

The copy and its build stand in DIR; the working tree is only read. The mutants of a file are built many at once
(mutant_batch.py). A mutant is killed by a failing or crashing killer or by its time limit; one that does not compile is
counted apart; survivors are printed with file, line, before and after. Survivors explained in mutants_equivalent.txt are
counted apart. Exit code 0: no other survivor; 1: some; 2: no baseline.
"""
import argparse
import json
import os
import random
import re
import resource
import shutil
import subprocess
import sys
import time

import mutant_batch
from mutations import mutants

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
# Sources, and the operators and parts (mutant_killer.cpp) that hold them.
FILES = {
    **dict.fromkeys(["plan.cpp", "elimination.cpp", "dissection.cpp"], "plans Elimination lcaba aba_sweep"), "plan.h": "plans lcaba aba_sweep lcaba_refined",
    "block_diagonal.cpp": "lcaba aba_sweep proximal", "block_diagonal.h": "kernels lcaba aba_sweep proximal",
    **dict.fromkeys(["factor.cpp", "factor_steps.cpp", "link_rows.cpp"], "kernels lcaba aba_sweep"), "sweep.cpp": "kernels lcaba lcaba_refined", "six.h": "kernels lcaba aba_sweep lcaba_refined",
    "columns.h": "Columns lcaba aba_sweep lcaba_refined",
    "kkt_residual.cpp": "kernels lcaba_refined", "vectors.h": "refinement lcaba_refined", "wide.h": "kernels lcaba_refined",
    "refinement.cpp": "refinement lcaba_refined", "refinement.h": "refinement lcaba_refined",
    "ldlt.h": "dense_cholesky lcaba", "explicit.cpp": "dense_cholesky explicit_columns", **dict.fromkeys(["symmetric_tiles.cpp", "coupled_rows.cpp"], "Tiles CoupledRows dense_cholesky caba_osim"), **dict.fromkeys(["ltl.cpp", "branch_factor.cpp", "branch_rows.cpp", "branch_rows.h"], "ltl_osim ltl_kkt"), "cg.cpp": "krylov cg cg_preconditioned",
    "ldlt_pivoted.h": "dependent elimination kkt_elimination", "kkt_elimination.cpp": "dependent elimination kkt_elimination dense_refined",
    "capped_inverse.cpp": "capped krylov proximal lcaba_float cg_preconditioned", "proximal.cpp": "proximal lcaba_float", "ladder.cpp": "Rungs ladder",
    "choose.cpp": "Choose", "auto.cpp": "Auto",
    "pair_sums.h": "pv_osim pv_osimr kjr", "thin_product.h": "ltl_osim pv_osimr", "mobility.h": "pv_osimr kjr efp efpa", "pv_osim.h": "pv_osim pv_osimr",
    **dict.fromkeys(["row_plan.cpp", "row_plan.h", "row_propagation.cpp"], "pv_osim pv_osimr caba_osim caba_osimr"), "caba_osim.cpp": "caba_osim caba_osimr",
    **dict.fromkeys(["mobility_form.cpp", "mobility_form.h"], "kjr efp efpa"),
    "operator.cpp": "dense_cholesky aba_sweep lcaba_refined", "damping.cpp": "lcaba aba_sweep",
    **dict.fromkeys(["weight_root.cpp", "weight_root.h", "mass_root.cpp", "front_plan.cpp", "householder.h", "square_root_factor.cpp",
                     "square_root_solve.cpp"], "Householder SquareRoot WeightRoot MassRoot square_root lcaba_qr")}

# Sources of the way in, and the suites of unit tests (models_killer.cpp) that hold them; the short ones hold them all.
SHORT = ("assembly Assembly Bad Field integrate JointLimits kinematics Mesh Mjcf model Names Refusals regularity rows Said SceneFile SceneLaws Scenes SelfContacts "
         "Standing Tolerances ZeroSize ")
WAY_IN = {
    **dict.fromkeys(["box_contacts.cpp", "capsule_box.cpp", "contacts.cpp", "farthest.cpp", "segments.cpp"], "Segments BoxContacts CapsuleBox ContactLaws HullContacts ConvexContacts"),
    "near_pairs.cpp": "NearPairs ContactLaws",
    **dict.fromkeys(["convex_shape.cpp", "convex_axis.cpp", "closest_points.cpp", "rim_axis.cpp", "convex_face.cpp", "convex_contacts.cpp"], "ConvexContacts ContactLaws"),
    **dict.fromkeys(["scene.cpp", "scene_contacts.cpp", "scene_constraints.cpp", "scene_robots.cpp", "scene_assembly.cpp", "yaml.cpp"], "Description"),
    **dict.fromkeys(["parts.cpp", "robot_bodies.cpp", "urdf.cpp", "urdf_check.cpp", "urdf_joints.cpp", "urdf_links.cpp", "urdf_leftover.cpp", "urdf_reading.cpp", "urdf_xml.cpp", "xml_lines.cpp",
                     "inertia_check.cpp", "robot.cpp"], "Description Urdf Formats RobotRefusals"),
    **dict.fromkeys(["sdf.cpp", "sdf_joints.cpp", "sdf_document.cpp", "sdf_said.cpp", "sdf_text.cpp", "sdf_counts.cpp"], "Sdf Formats RobotRefusals"),
    **dict.fromkeys(["mjcf.cpp", "mjcf_shapes.cpp", "mjcf_equalities.cpp", "mjcf_compile.cpp", "mjcf_xml.cpp", "mjcf_said.cpp", "mjcf_newer.cpp"], "Formats RobotRefusals"),
    **dict.fromkeys(["mesh.cpp", "hull.cpp", "facets.cpp"], "Hull ConvexContacts"), "closest.h": "", "scene_files.cpp": "",
    **dict.fromkeys(["kinematics.cpp", "mechanism.cpp", "mechanism_rows.cpp"], "moving Description"), "constraints.cpp": "closure moving",
    **dict.fromkeys(["loop_closing.cpp", "loop_newton.cpp", "closure_error.cpp"], "closure"), "model.cpp": "", "regularity.cpp": ""}
WAY_IN = {name: SHORT + suites for name, suites in WAY_IN.items()}
FILES.update(WAY_IN)
for source in sorted(os.listdir(os.path.join(ROOT, "algorithms", "operators"))):  # the rest: a file is called as the operator it is
    if source.endswith(".cpp") and source not in ("operators.cpp", "kernel_costs.cpp"):
        FILES.setdefault(source, source[:-len(".cpp")])


def killer_of(name):
    return "models_killer" if name in WAY_IN else "mutant_killer"


def folder_of(name):
    rooms = [part + "/" + room for part in ("algorithms", "models") for room in sorted(os.listdir(os.path.join(ROOT, part)))]
    return "" if "/" in name else next((f for f in rooms if os.path.exists(os.path.join(ROOT, f, name))), "models")


def read_equivalent(path):
    """{(file, before, after): reason}; an entry is `file`, then `- before` and `+ after` lines, then `= reason` for all of them."""
    entries, pairs, name, before = {}, [], None, None
    for line in open(path, encoding="utf-8").read().split("\n") if os.path.exists(path) else []:
        if line.startswith("- "):
            before = line[2:].strip()
        elif line.startswith("+ "):
            pairs.append((name, before, line[2:].strip()))
        elif line.startswith("= "):
            entries.update({pair: line[2:].strip() for pair in pairs})
            pairs = []
        elif line and not line.startswith("#"):
            name = line.strip()
    return entries


def stale(path, once):
    """Entries whose line the source no longer has, or has more than once where `once`."""
    out = []
    for name, before, _ in read_equivalent(path):
        source = os.path.join(ROOT, folder_of(name), name)
        lines = [line.strip() for line in open(source, encoding="utf-8")] if os.path.exists(source) else []
        if before not in lines or once and lines.count(before) != 1:
            out.append("%s: %d lines of %s read: %s" % (os.path.basename(path), lines.count(before), name, before))
    return out


def check():
    """What a change of a source left behind in the two lists; the number of it."""
    found = stale(os.path.join(HERE, "mutants_equivalent.txt"), False) + stale(os.path.join(HERE, "seeded_faults.txt"), True)
    for text in dict.fromkeys(found):
        print(text)
    if found:
        print("follow the source, or delete what no longer holds")
    return len(found)


def read_faults(path, texts):
    """Faults seeded by hand: like the entries of read_equivalent, the kind of fault behind `= `. Each changes one line."""
    out = []
    for (name, before, after), kind in read_equivalent(path).items():
        if name not in texts:
            continue
        lines = texts[name].split("\n")
        places = [k for k, line in enumerate(lines) if line.strip() == before]
        if len(places) != 1:
            sys.exit("mutate.py: %s: %d lines of %s read: %s" % (path, len(places), name, before))
        line = lines[places[0]]
        out.append({"file": name, "line": places[0] + 1, "kind": kind, "before": before, "after": after,
                    "text": line[:len(line) - len(line.lstrip())] + after})
    return out


def fault_table(done):
    print("| kind | source | noticed by |\n|---|---|---|")
    for m in done:
        by = "**nobody**" if m["outcome"] == "survived" else "`%s`" % m["by"].split(":")[0] if m["outcome"] == "failed" else m["outcome"]
        print("| %s | `%s` | %s |" % (m["kind"], m["file"], by))
    return sum(m["outcome"] == "survived" for m in done)


class Copy:
    """A copy of a commit, with the killer of the working tree and a build of its own. Of the operators' files little is
    compiled, and that with little optimisation: double and Rational; float for factors narrower than double. For the way
    in everything is built as in the tree, the mutated files with little optimisation."""

    def __init__(self, work, commit, files):
        self.way_in = [name for name in files if name in WAY_IN]
        if self.way_in and len(self.way_in) < len(files):
            sys.exit("mutate.py: files of operators and of the way in need two runs, each with a folder of its own")
        self.tree = os.path.join(work, "tree")
        self.build = os.path.join(self.tree, "build", "release") if self.way_in else os.path.join(work, "build")
        os.makedirs(self.tree, exist_ok=True)
        archive = subprocess.run(["git", "-C", ROOT, "archive", commit], stdout=subprocess.PIPE, check=True).stdout
        fresh = os.path.join(work, "fresh")
        subprocess.run(["rm", "-rf", fresh], check=True)
        os.makedirs(fresh)
        subprocess.run(["tar", "-x", "-C", fresh], input=archive, check=True)
        for name in ("mutant_killer.cpp", "models_killer.cpp", "killing.cpp", "killing.h"):
            shutil.copy(os.path.join(HERE, name), os.path.join(fresh, "property_tests", "mutation"))
        if self.way_in:
            with open(os.path.join(fresh, "CMakeLists.txt"), "a", encoding="utf-8") as f:
                f.write("set_target_properties(delassus_models PROPERTIES UNITY_BUILD OFF)\n")
        for name in self.way_in:  # what is not mutated comes from the compiler's cache
            part, _, room = folder_of(name).partition("/")
            with open(os.path.join(fresh, part, "CMakeLists.txt"), "a", encoding="utf-8") as f:
                f.write("set_source_files_properties(%s PROPERTIES COMPILE_OPTIONS \"-w;-O1;-UNDEBUG\")\n" % os.path.join(room, name))
        if not self.way_in:
            self.fewer_scalars(fresh)
        self.take_over(fresh)

    def take_over(self, fresh):
        """Makes the tree equal to `fresh` without touching files that are equal already."""
        for folder, _, names in os.walk(fresh):
            to = os.path.join(self.tree, os.path.relpath(folder, fresh))
            os.makedirs(to, exist_ok=True)
            for name in names:
                source, target = os.path.join(folder, name), os.path.join(to, name)
                if not os.path.exists(target) or open(source, "rb").read() != open(target, "rb").read():
                    os.replace(source, target)
                    os.utime(target)  # newer than what was built of it

    @staticmethod
    def fewer_scalars(fresh):
        """One library for double, float and Rational instead of two for all scalars."""
        def edit(path, pattern, by):
            path = os.path.join(fresh, "algorithms", path)
            text, count = re.subn(pattern, by, open(path, encoding="utf-8").read())
            if not count:
                sys.exit("mutate.py: %s has no %s" % (path, pattern))
            open(path, "w", encoding="utf-8").write(text)
        edit("kit/instantiate.h", r"(#define DELASSUS_FOR_EACH_(?:ORDERED_)?SCALAR\(X\)) X\(double\) X\(float\)", r"\1 X(double) X(float) X(::delassus::Rational)")
        edit("kit/instantiate.h", r"#else", '#else\n#include "algorithms/kit/exact.h"')
        edit("CMakeLists.txt", r"STATIC \$\{delassus_recursions\}", "STATIC problem/problem.cpp")
        with open(os.path.join(fresh, "algorithms", "CMakeLists.txt"), "a", encoding="utf-8") as f:
            f.write("target_precompile_headers(delassus PRIVATE <Eigen/Core> <gmpxx.h>)\n"
                    "target_compile_options(delassus PRIVATE -O1)\ntarget_compile_definitions(delassus PRIVATE _GLIBCXX_ASSERTIONS)\n")

    def configure(self):
        if self.way_in:
            subprocess.run(["cmake", "--preset", "release", "-DDELASSUS_UNITY=ON"], check=True, stdout=subprocess.DEVNULL, cwd=self.tree)
        elif not os.path.exists(os.path.join(self.build, "build.ninja")):
            subprocess.run(["cmake", "-S", self.tree, "-B", self.build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=None", "-DCCACHE=OFF", "-DDELASSUS_UNITY=OFF",
                            "-DCMAKE_CXX_FLAGS=-O2 -march=native -w",
                            # scalars that are not compiled are not called either
                            "-DCMAKE_EXE_LINKER_FLAGS=-no-pie -Wl,--unresolved-symbols=ignore-all"], check=True, stdout=subprocess.DEVNULL)

    def read(self, name):
        return open(os.path.join(self.tree, folder_of(name), name), encoding="utf-8").read()

    def write(self, name, text):
        open(os.path.join(self.tree, folder_of(name), name), "w", encoding="utf-8").write(text)

    def make(self, name):
        return subprocess.run(["ninja", "-j1", "-k0", "-C", self.build, killer_of(name)], stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, errors="replace")

    def kill(self, name, count):
        """[(outcome, what the killer said)] of mutants 1 … count; ends where the program unchanged does not pass."""
        def limits():
            resource.setrlimit(resource.RLIMIT_AS, (2 << 30, 2 << 30))
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        program = os.path.join(self.build, "property_tests", killer_of(name))
        with subprocess.Popen([program, "--mutants", str(count)] + FILES[name].split(), stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                              text=True, errors="replace", preexec_fn=limits, cwd=self.tree) as killer:
            said = []
            for line in killer.stdout:  # tests print, too
                if found := re.match(r"(\d+) (survived|failed|crashed|time) (.*)", line):
                    said.append(found.groups()[1:])
                    if found.group(2) == "survived":
                        print("%s of %d: survived %s" % (found.group(1), count, found.group(3)), flush=True)
        if said and said[0][0] != "survived":
            print("the unchanged tree does not pass:", name, *said[0])
            sys.exit(2)
        if len(said) != count + 1:
            raise RuntimeError("the killer ended with %d after %d of %d" % (killer.returncode, len(said) - 1, count))
        return said[1:]


def judge(copy, texts, group):
    """Outcomes of mutants of files that the same suites hold, all in one program."""
    if not group:
        return
    for name in dict.fromkeys(m["file"] for m in group):
        numbers = [k for k, m in enumerate(group) if m["file"] == name]
        copy.write(name, mutant_batch.compose(name, texts[name], group[numbers[0]:numbers[-1] + 1], numbers[0] + 1))
    made = copy.make(group[0]["file"])
    if made.returncode == 0:
        for mutant, (outcome, by) in zip(group, copy.kill(group[0]["file"], len(group))):
            mutant["outcome"], mutant["by"] = outcome, by
        return
    for m in group:
        copy.write(m["file"], texts[m["file"]])
    guilty = mutant_batch.blamed(made.stdout) if len(group) > 1 else {1}
    for number in guilty:
        group[number - 1]["outcome"] = "compiler"
    rest = [m for number, m in enumerate(group, 1) if number not in guilty]
    for part in [rest] if guilty else [rest[::2], rest[1::2]]:
        judge(copy, texts, part)


def summary(done, equivalent):
    """Prints the table and the survivors; the number of unexplained ones."""
    unexplained = []
    print("| file | mutants | not compiled | killed | equivalent | survived | share killed |\n|---|---|---|---|---|---|---|")
    for name in [*FILES, "all"]:
        of_file = [m for m in done if name in ("all", m["file"])]
        survivors = [m for m in of_file if m["outcome"] == "survived"]
        explained = [m for m in survivors if (m["file"], m["before"], m["after"]) in equivalent]
        refused = sum(m["outcome"] == "compiler" for m in of_file)
        killed = len(of_file) - refused - len(survivors)
        judged = killed + len(survivors) - len(explained)
        if of_file:
            print("| %s | %d | %d | %d | %d | %d | %.1f %% |" % (name, len(of_file), refused, killed, len(explained),
                  len(survivors) - len(explained), 100.0 * killed / max(1, judged)))
        if name == "all":
            unexplained = [m for m in survivors if m not in explained]
    for m in unexplained:
        print("\n%s:%d (%s)\n- %s\n+ %s" % (m["file"], m["line"], m["kind"], m["before"], m["after"]))
    return len(unexplained)


def chosen(options, texts):
    if options.faults:
        return read_faults(options.faults, texts)
    out = []
    for name in options.files:
        spans = mutant_batch.bodies(texts[name])
        every = [m for m in mutants(name, texts[name]) if mutant_batch.place(texts[name], spans, m)]
        if 0 < options.sample < len(every):  # of a file alone: what else is run does not change it
            every = sorted(random.Random("%d %s" % (options.seed, name)).sample(every, options.sample), key=lambda m: m["line"])
        out += every
    return out


def numbered(some):
    """[(key, mutant)] in the order of lines; the key stays the same when lines are put in or left out elsewhere."""
    count, out = {}, []
    for m in sorted(some, key=lambda m: (m["file"], m["line"])):
        same = m["file"], m["before"], m["after"]
        count[same] = count.get(same, 0) + 1
        out.append((same + (count[same],), m))
    return out


def judged_before(options, todo, equivalent):
    """{key: mutant} of --json, without what is no mutant any more or to be judged again."""
    if not (options.resume or options.again) or not os.path.exists(options.json):
        return {}
    now, done = dict(numbered(todo)), {}
    for key, m in numbered(json.load(open(options.json))):
        again = options.again and m["outcome"] == "survived" and key[:3] not in equivalent
        if m["file"] not in options.files:
            done[key] = m
        elif key in now and not again:
            done[key] = dict(m, line=now[key]["line"])
    return done


def run(options, equivalent):
    copy = Copy(options.work, options.commit, options.files)
    texts = {name: copy.read(name) for name in options.files}
    todo = chosen(options, texts)
    if options.list:
        for m in todo:
            print("%s:%d %s\n- %s\n+ %s" % (m["file"], m["line"], m["kind"], m["before"], m["after"]))
        print(len(todo), "mutants")
        return 0
    before = judged_before(options, todo, equivalent)
    done, todo = list(before.values()), [m for key, m in numbered(todo) if key not in before]
    copy.configure()
    made = copy.make(options.files[0])
    if made.returncode:
        print("the unchanged tree does not compile:", made.stdout[-2000:])
        return 2
    for suites in dict.fromkeys(FILES[name] for name in options.files):
        together = [m for m in todo if FILES[m["file"]] == suites]
        for group in [together[k:k + options.batch] for k in range(0, len(together), options.batch)]:
            start = time.time()
            judge(copy, texts, group)
            for m in group:
                del m["text"]
                copy.write(m["file"], texts[m["file"]])
            done += group
            if options.json:
                json.dump(done, open(options.json, "w"), indent=1, ensure_ascii=False)
            count = lambda *outcomes: sum(m["outcome"] in outcomes for m in group)
            print("%s:%d to %s:%d, %d mutants, %d not compiled, %d survived, %d by time, %.0f s" % (group[0]["file"], group[0]["line"], group[-1]["file"],
                  group[-1]["line"], len(group), count("compiler"), count("survived"), count("time"), time.time() - start), flush=True)
    return 1 if (fault_table(done) if options.faults else summary(done, equivalent)) else 0


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--work", help="folder for the copy and its build")
    p.add_argument("--commit", default="HEAD", help="whose sources are mutated (HEAD)")
    p.add_argument("--files", nargs="+", default=[f for f in FILES if os.path.exists(os.path.join(ROOT, folder_of(f), f))], choices=list(FILES), metavar="FILE")
    p.add_argument("--sample", type=int, default=0, help="that many of each file, drawn at random; 0: all")
    p.add_argument("--seed", type=int, default=1)
    p.add_argument("--batch", type=int, default=40, help="mutants in one program")
    p.add_argument("--json", help="all outcomes, rewritten after every batch")
    p.add_argument("--resume", action="store_true", help="keep the outcomes in --json")
    p.add_argument("--again", action="store_true", help="the same, but judge its unexplained survivors again")
    p.add_argument("--faults", help="judge the faults of this file (property_tests/mutation/seeded_faults.txt) instead of every mutant")
    p.add_argument("--table", action="store_true", help="print what --json holds and stop")
    p.add_argument("--check", action="store_true", help="say which entries of the two lists name lines that are gone, and stop")
    p.add_argument("--list", action="store_true", help="print the mutants and stop")
    options = p.parse_args()
    equivalent = read_equivalent(os.path.join(HERE, "mutants_equivalent.txt"))
    if options.check:
        sys.exit(1 if check() else 0)
    if options.table:
        sys.exit(1 if summary(json.load(open(options.json)), equivalent) else 0)
    sys.exit(run(options, equivalent))


if __name__ == "__main__":
    main()
