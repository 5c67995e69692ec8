#!/usr/bin/env python3
"""Three mutants of a small source: one that a program notices, one it cannot, one that does not compile.

    mutant_batch_test.py COMPILER
"""
import os
import subprocess
import sys
import tempfile

import mutant_batch
from mutations import mutants

SOURCE = """// The larger half, and a "brace {" in a comment.
constexpr int half(int x) { return (x + 1) / 2; }
template <class T> T largest(const T* begin, const T* end) {
  T most = *begin;
  for (const T* at = begin; at != end; ++at)
    if (*at > most) most = *at;
  return most;
}
"""
MAIN = """#include <cstdlib>
int delassus_mutant = 0;
%s
int main(int, char** argv) {
  delassus_mutant = std::atoi(argv[1]);
  const int numbers[] = {1, 7, 3};
  return half(5) == 3 && largest(numbers, numbers + 3) == 7 ? 0 : 1;
}
"""
WANTED = ["return (x + 1) * 2;", "if (*at >= most) most = *at;", "T most = *at;"]


def build(compiler, folder, text):
    source = os.path.join(folder, "source.cpp")
    with open(source, "w", encoding="utf-8") as f:
        f.write(MAIN % text)
    return subprocess.run([compiler, "-std=c++20", "-w", source, "-o", os.path.join(folder, "program")], stderr=subprocess.PIPE, text=True)


def main():
    spans = mutant_batch.bodies(SOURCE)
    assert [SOURCE[a - 1] + SOURCE[b] for a, b in spans] == ["{}", "{}"], spans
    every = mutants("source.cpp", SOURCE) + [{"file": "source.cpp", "line": 4, "text": "  T most = *at;", "after": "T most = *at;"}]
    three = [next(m for m in every if wanted in m["after"]) for wanted in WANTED]
    assert all(mutant_batch.place(SOURCE, spans, m) for m in three)
    with tempfile.TemporaryDirectory() as folder:
        refused = build(sys.argv[1], folder, mutant_batch.compose("source.cpp", SOURCE, three))
        assert refused.returncode != 0 and mutant_batch.blamed(refused.stderr) == {3}, refused.stderr
        assert build(sys.argv[1], folder, mutant_batch.compose("source.cpp", SOURCE, three[:2])).returncode == 0
        said = [subprocess.run([os.path.join(folder, "program"), str(k)]).returncode for k in range(3)]
    assert said == [0, 1, 0], said


if __name__ == "__main__":
    main()
