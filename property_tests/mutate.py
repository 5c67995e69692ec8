#!/usr/bin/env python3
"""Mutation testing of the operators' sources: one change at a time in a copy of a commit, which the program
mutant_killer must notice.

    property_tests/mutate.py --work DIR [--files factor.cpp sweep.cpp ...] [--sample N --seed S] [--shard i/n]
                             [--json FILE [--resume]] [--list]

The copy and its build stand in DIR; the working tree is only read. A mutant is killed by a failing or crashing killer or
by the time limit; one that does not compile is counted apart; survivors are printed with file, line, before and after.
Survivors explained in mutants_equivalent.txt are counted apart. Exit code 0: no other survivor; 1: some; 2: no baseline.
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

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(HERE)
FILES = ["factor.cpp", "sweep.cpp", "elimination.cpp", "lcaba.cpp", "aba_sweep.cpp", "kkt_residual.cpp",
         "lcaba_refined.cpp", "refinement.cpp", "block_diagonal.cpp", "cg.cpp", "columns.h", "ldlt.h", "dense_cholesky.cpp", "six.h"]

# Token for token: what stands between spaces is a binary operator in this code.
SWAPS = [(" + ", " - "), (" - ", " + "), (" * ", " / "), (" / ", " * "), (" += ", " -= "), (" -= ", " += "),
         (" *= ", " /= "), (" < ", " <= "), (" <= ", " < "), (" > ", " >= "), (" >= ", " > "), (" == ", " != "),
         (" != ", " == "), (" && ", " || "), (" || ", " && "), ("std::max", "std::min"), ("std::min", "std::max"),
         (".begin()", ".end()"), (".end()", ".begin()"), ("add_scaled(", "subtract_scaled("),
         ("subtract_scaled(", "add_scaled("), ("add_outer(", "subtract_outer("), ("subtract_outer(", "add_outer("),
         ("transposed(", "("), (".transpose()", "")]
# Names that are easily taken for each other.
NAMES = [("i", "j"), ("r", "q"), ("c", "d"), ("k", "l"), ("a", "b"), ("x", "y"), ("wk", "wl"), ("begin", "end"),
         ("row", "rows"), ("n", "m"), ("n", "q"), ("r1", "r2"), ("d_nu", "nu"), ("d_lambda", "lambda"), ("f", "u"),
         ("inertia_", "inertia0_"), ("joint_k_", "joint_k0_"), ("first_column", "first_member"), ("body", "step"),
         ("factor_", "factor_M_")]
STATEMENT = re.compile(r"^(?:(?:if|for|else|while) ?\(.*?\) (?=\S))?(?:\+\+|--|\*)?[a-zA-Z_][\w.\->:\[\]+* /]*(?:\(.*\)|<[^;]*>\(.*\)| [-+*/]?= .*|\+\+|--)?;$")
DECLARATION = re.compile(r"^(?:const|auto|using|return|break|continue|static|constexpr|template|std::vector|std::set|int|Index|"
                         r"double|bool|T|V|W|Six<|Report|Plan|Blocks|Buffers|Neighbours|Cliques|const_cast|struct|class|virtual|"
                         r"VectorX|MatrixX|Workspace|public|private|Tree)\b")


def without_comments(line):
    code = re.sub(r'"(?:\\.|[^"\\])*"', lambda m: '"' + " " * (len(m.group()) - 2) + '"', line)
    at = code.find("//")
    return code if at < 0 else code[:at]


def arguments(code, at):
    """Spans of the arguments of the call whose parenthesis opens at `at`; None when it does not close on this line."""
    depth, start, spans = 0, at + 1, []
    for k in range(at, len(code)):
        if code[k] in "([{":
            depth += 1
        elif code[k] in ")]}":
            depth -= 1
            if depth == 0:
                return spans + [(start, k)]
        elif code[k] == "," and depth == 1:
            spans.append((start, k))
            start = k + 1
    return None


def mutants_of_line(line, known):
    """(kind, mutated line), each once. `known`: identifiers of the function around it."""
    code = without_comments(line)
    head = len(code) - len(code.lstrip())

    def put(begin, end, text):
        return line[:begin] + text + line[end:]

    for old, new in SWAPS:
        for m in re.finditer(re.escape(old), code):
            if old.endswith("(") and m.start() and (code[m.start() - 1].isalnum() or code[m.start() - 1] == "_"):
                continue
            yield "operator", put(m.start(), m.end(), new)
    for m in re.finditer(r"(?<![\w.])\d+(?![\w.])", code):
        yield "constant", put(m.start(), m.end(), "0" if m.group() == "1" else str(int(m.group()) + 1))
    for m in re.finditer(r"(?<=[(=,\[] )-(?=[\w(])|(?<=[(\[])-(?=[\w(])", code):
        if code[m.start() + 1:m.start() + 2] not in "01":
            yield "sign", put(m.start(), m.end(), "")
    for m in re.finditer(r"\[(\w+)\]", code):
        if not m.group(1).isdigit():
            yield "index", put(m.start(), m.end(), "[" + m.group(1) + " + 1]")
    for left, right in NAMES:
        for old, new in ((left, right), (right, left)):
            if new not in known:
                continue
            for m in re.finditer(r"\b" + old + r"\b", code):
                yield "name", put(m.start(), m.end(), new)
    for m in re.finditer(r"\b(?:add_outer|subtract_outer|subtract_schur|dot|multiply|push_back|insert|erase|swap)\(", code):
        spans = arguments(code, m.end() - 1)
        if spans and len(spans) >= 2:
            (a, b), (c, d) = spans[-2], spans[-1]
            yield "arguments", line[:a] + line[c:d].rjust(1) + line[b:c] + line[a:b] + line[d:]
    for m in re.finditer(r"\bif \(", code):
        spans = arguments(code, m.end() - 1)
        if spans:
            for value in ("true", "false"):
                yield "condition", put(spans[0][0], spans[-1][1], value)
    bare = code.strip()
    if STATEMENT.match(bare) and not DECLARATION.match(bare):
        start = head
        control = re.match(r"(?:if|for|while) ", bare)
        if control:
            spans = arguments(code, code.index("(", head))
            if not spans or code[spans[-1][1] + 1:].strip() == ";":
                return
            start = spans[-1][1] + 2
        yield "statement", line[:start] + ";"


def names_around(lines):
    """Per line the identifiers of the function it belongs to: functions end with a brace in the first column."""
    out, start = [], 0
    for number, line in enumerate(lines):
        if line.startswith("}") or number == len(lines) - 1:
            names = set(re.findall(r"\w+", " ".join(without_comments(x) for x in lines[start:number + 1])))
            out += [names] * (number + 1 - start)
            start = number + 1
    return out


def mutants(name, text):
    """Every mutant of a file as a dictionary. bytes() is an estimate for tables and is left out."""
    lines = text.split("\n")
    known, skipped, out = names_around(lines), False, []
    for number, line in enumerate(lines):
        if re.search(r"\b(?:do_)?bytes\(\) const", line):
            skipped = True
        code = without_comments(line)
        if not skipped and code.strip() and not code.lstrip().startswith(("#", "template <class", "using", "namespace", "}  //", "\\")) \
                and "DELASSUS_INSTANTIATE" not in code:
            seen = {line.strip()}
            for kind, changed in mutants_of_line(line, known[number]):
                if changed.strip() in seen:
                    continue
                seen.add(changed.strip())
                out.append({"file": name, "line": number + 1, "kind": kind, "before": line.strip(), "after": changed.strip(),
                            "text": changed})
        if skipped and (line.startswith("}") or re.search(r"\{.*\}$", line)):
            skipped = False
    return out


def read_equivalent(path):
    """{(file, before, after): reason}; an entry is `file`, `- before`, `+ after`, `= reason`."""
    entries, entry = {}, {}
    for line in open(path, encoding="utf-8").read().split("\n") if os.path.exists(path) else []:
        if line.startswith(("- ", "+ ", "= ")):
            entry[line[0]] = line[2:].strip()
        elif line and not line.startswith("#"):
            entry["file"] = line.strip()
        if line.startswith("= "):
            entries[entry["file"], entry["-"], entry["+"]] = entry["="]
    return entries


class Copy:
    """A copy of a commit, with the killer of the working tree and a build of its own. Only double and Rational are compiled in the operators' files."""

    def __init__(self, work, commit):
        self.tree, self.build = os.path.join(work, "tree"), os.path.join(work, "build")
        os.makedirs(self.tree, exist_ok=True)
        archive = subprocess.run(["git", "-C", ROOT, "archive", commit], stdout=subprocess.PIPE, check=True).stdout
        fresh = os.path.join(work, "fresh")
        subprocess.run(["rm", "-rf", fresh], check=True)
        os.makedirs(fresh)
        subprocess.run(["tar", "-x", "-C", fresh], input=archive, check=True)
        shutil.copy(os.path.join(HERE, "mutant_killer.cpp"), os.path.join(fresh, "property_tests"))
        self.fewer_scalars(os.path.join(fresh, "algorithms"))
        with open(os.path.join(fresh, "algorithms", "CMakeLists.txt"), "a", encoding="utf-8") as f:
            f.write("target_precompile_headers(delassus PRIVATE <Eigen/Core> <gmpxx.h>)\n")
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
    def fewer_scalars(folder):
        for name in os.listdir(folder):
            if not name.endswith(".cpp") or name in ("operator.cpp", "problem.cpp", "block_diagonal.cpp", "kinematics.cpp", "constraints.cpp"):
                continue
            path = os.path.join(folder, name)
            text = open(path, encoding="utf-8").read()
            if name == "registry.cpp":
                text = re.sub(r"make<(\w+), (?:float|Quad|Counted|PrimeField)>", "nullptr", text)
            else:
                text = re.sub(r"^DELASSUS_FOR_EACH\w*SCALAR\((\w+)\)", r"\1(double) \1(::delassus::Rational)", text, flags=re.M)
            open(path, "w", encoding="utf-8").write(text)

    def configure(self):
        if not os.path.exists(os.path.join(self.build, "build.ninja")):
            subprocess.run(["cmake", "-S", self.tree, "-B", self.build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=None", "-DCCACHE=OFF",
                            "-DCMAKE_CXX_FLAGS=-O1 -march=native -w",
                            # scalars that are not compiled are not called either
                            "-DCMAKE_EXE_LINKER_FLAGS=-no-pie -Wl,--unresolved-symbols=ignore-all"], check=True, stdout=subprocess.DEVNULL)

    def path(self, name):
        return os.path.join(self.tree, "algorithms", name)

    def make(self):
        return subprocess.run(["ninja", "-j1", "-C", self.build, "mutant_killer"], stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True)

    def kill(self, seconds):
        """(outcome, what the killer said)."""
        def limits():
            resource.setrlimit(resource.RLIMIT_AS, (8 << 30, 8 << 30))
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        try:
            done = subprocess.run([os.path.join(self.build, "property_tests", "mutant_killer")], stdout=subprocess.PIPE,
                                  stderr=subprocess.DEVNULL, text=True, errors="replace", timeout=seconds, preexec_fn=limits)
        except subprocess.TimeoutExpired:
            return "time", ""
        said = " ".join(done.stdout.split())[:160]
        return ("survived" if done.returncode == 0 else "failed" if done.returncode == 1 else "crashed"), said


def judge(copy, mutant, original, seconds):
    path = copy.path(mutant["file"])
    lines = original.split("\n")
    lines[mutant["line"] - 1] = mutant.pop("text")
    open(path, "w", encoding="utf-8").write("\n".join(lines))
    start = time.time()
    if copy.make().returncode != 0:
        mutant["outcome"] = "compiler"
    else:
        mutant["outcome"], mutant["by"] = copy.kill(seconds)
    mutant["seconds"] = round(time.time() - start, 1)
    open(path, "w", encoding="utf-8").write(original)


def summary(done, equivalent):
    """Prints the table and the survivors; the number of unexplained ones."""
    unexplained = []
    print("| file | mutants | not compiled | killed | equivalent | survived | share killed |\n|---|---|---|---|---|---|---|")
    totals = [0] * 5
    for name in FILES + ["all"]:
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
    every = [m for name in options.files for m in mutants(name, texts[name])]
    if options.sample:
        every = sorted(random.Random(options.seed).sample(every, min(options.sample, len(every))),
                       key=lambda m: (FILES.index(m["file"]), m["line"]))
    i, n = map(int, options.shard.split("/"))
    return every[i - 1::n]


def run(options):
    copy = Copy(options.work, options.commit)
    texts = {name: open(copy.path(name), encoding="utf-8").read() for name in options.files}
    todo = chosen(options, texts)
    if options.list:
        for m in todo:
            print("%s:%d %s\n- %s\n+ %s" % (m["file"], m["line"], m["kind"], m["before"], m["after"]))
        print(len(todo), "mutants")
        return 0
    copy.configure()
    made = copy.make()
    start = time.time()
    outcome, said = copy.kill(600) if made.returncode == 0 else ("compiler", made.stdout[-2000:])
    baseline = time.time() - start
    if outcome != "survived":
        print("the unchanged tree does not pass:", outcome, said)
        return 2
    print("unchanged: %.1f s; %d mutants" % (baseline, len(todo)), flush=True)
    key = lambda m: (m["file"], m["before"], m["after"], m["line"])
    done = json.load(open(options.json)) if options.resume and os.path.exists(options.json) else []
    known = {key(m) for m in done}
    todo = [m for m in todo if key(m) not in known]
    start = time.time()
    for k, mutant in enumerate(todo):
        judge(copy, mutant, texts[mutant["file"]], 4 * baseline + 5)
        done.append(mutant)
        if options.json:
            json.dump(done, open(options.json, "w"), indent=1, ensure_ascii=False)
        left = (time.time() - start) / (k + 1) * (len(todo) - k - 1)
        print("%d/%d %s:%d %s %.1f s, %.0f min left" % (k + 1, len(todo), mutant["file"], mutant["line"], mutant["outcome"],
              mutant["seconds"], left / 60), flush=True)
    copy.make()
    return 1 if summary(done, read_equivalent(os.path.join(HERE, "mutants_equivalent.txt"))) else 0


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--work", required=True, help="folder for the copy and its build")
    p.add_argument("--commit", default="HEAD", help="whose sources are mutated (HEAD)")
    p.add_argument("--files", nargs="+", default=FILES, choices=FILES)
    p.add_argument("--sample", type=int, default=0, help="that many, drawn at random; 0: all")
    p.add_argument("--seed", type=int, default=1)
    p.add_argument("--shard", default="1/1")
    p.add_argument("--json", help="all outcomes, rewritten after every mutant")
    p.add_argument("--resume", action="store_true", help="keep the outcomes in --json")
    p.add_argument("--list", action="store_true", help="print the mutants and stop")
    options = p.parse_args()
    if not re.fullmatch(r"[1-9]\d*/[1-9]\d*", options.shard):
        p.error("--shard i/n")
    sys.exit(run(options))


if __name__ == "__main__":
    main()
