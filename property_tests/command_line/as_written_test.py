#!/usr/bin/env python3
"""Sources compiled with -ffp-contract=off read no precompiled header: g++ takes the option from that one, silently, and fuses
what error-free transformations need rounded.

as_written_test.py BUILD"""
import json
import os
import sys

with open(os.path.join(sys.argv[1], "compile_commands.json"), encoding="utf-8") as f:
    as_written = [c for c in json.load(f) if "-ffp-contract=off" in c["command"]]
wrong = [c["file"] for c in as_written if "cmake_pch" in c["command"]]
missing = {"kkt_residual.cpp", "refinement.cpp", "kernels.cpp"} - {os.path.basename(c["file"]) for c in as_written}
for file in wrong:
    print("%s is compiled with -ffp-contract=off and a precompiled header, which takes it back" % file)
for file in missing:
    print("%s is not compiled with -ffp-contract=off" % file)
sys.exit(1 if wrong or missing else 0)
