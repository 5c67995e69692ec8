// Instructions of a call, counted one by one in the very program that runs it: the processor stops behind each (its trap flag), a
// signal handler counts. What valgrind would count, on any kernels, AVX-512 too.
// Where    x86-64 and Linux; elsewhere, and under an emulator without the flag, nothing can be counted.
// Cost     a signal an instruction: 1 to 20 µs. What the call allocates on first use is counted too: call once before.
#pragma once

#include <cstdint>
#include <functional>
#include <typeinfo>
#include <vector>

namespace delassus {

/// A stretch of machine code, [begin, end).
struct Code {
  std::uintptr_t begin, end;
};

/// Functions that have the class in their name – its members and their thunks, what is made for it – by this program's own table of
/// symbols, ascending. Empty where there is no such table.
[[nodiscard]] std::vector<Code> code_of(const std::vector<const std::type_info*>& classes);

/// Instructions of the program's own code. Those of shared libraries are left out: how far malloc has to look depends on all that was
/// ever allocated.
struct Instructions {
  std::int64_t all = 0;
  std::int64_t inside = 0;  ///< of `code`
};

[[nodiscard]] bool can_count_instructions();

/// Instructions of f(), and how many of them lie in `code` (ascending). Not from two threads at once.
[[nodiscard]] Instructions count_instructions(const std::function<void()>& f, const std::vector<Code>& code = {});

}  // namespace delassus
