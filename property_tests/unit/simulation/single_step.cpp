#include "property_tests/unit/simulation/single_step.h"

#include <elf.h>
#include <link.h>
#include <signal.h>
#include <ucontext.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>

namespace delassus {
namespace {

/// This program's file.
std::string image() {
  std::ifstream in("/proc/self/exe", std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Where it was loaded, and its machine code: the first object of the list is the program.
struct Loaded {
  std::uintptr_t base = 0;
  Code code{};
};
Loaded loaded() {
  Loaded out;
  dl_iterate_phdr(
      [](dl_phdr_info* info, std::size_t, void* to) {
        auto& l = *static_cast<Loaded*>(to);
        l.base = info->dlpi_addr;
        for (int k = 0; k < info->dlpi_phnum; ++k) {
          const auto& part = info->dlpi_phdr[k];
          if (part.p_type == PT_LOAD && (part.p_flags & PF_X) != 0) l.code = {l.base + part.p_vaddr, l.base + part.p_vaddr + part.p_memsz};
        }
        return 1;
      },
      &out);
  return out;
}

template <class Entry> std::vector<Entry> entries(const std::string& file, std::uint64_t offset, std::uint64_t bytes) {
  std::vector<Entry> out(bytes / sizeof(Entry));
  if (offset + bytes > file.size()) return {};
  std::memcpy(out.data(), file.data() + offset, out.size() * sizeof(Entry));
  return out;
}

/// The class as it stands in mangled names: N8delassus…E without N and E.
std::string inner(const std::type_info& type) {
  const std::string name = type.name();
  return name.size() > 2 && name.front() == 'N' ? name.substr(1, name.size() - 2) : name;
}

}  // namespace

std::vector<Code> code_of(const std::vector<const std::type_info*>& classes) {
  std::vector<std::string> names;
  for (const std::type_info* type : classes) names.push_back(inner(*type));
  const std::string file = image();
  const auto head = entries<Elf64_Ehdr>(file, 0, sizeof(Elf64_Ehdr));
  std::vector<Code> out;
  if (head.empty() || std::memcmp(head[0].e_ident, ELFMAG, SELFMAG) != 0) return out;
  const auto sections = entries<Elf64_Shdr>(file, head[0].e_shoff, std::uint64_t{head[0].e_shnum} * sizeof(Elf64_Shdr));
  const std::uintptr_t base = loaded().base;
  for (const Elf64_Shdr& section : sections) {
    if (section.sh_type != SHT_SYMTAB) continue;
    for (const Elf64_Sym& symbol : entries<Elf64_Sym>(file, section.sh_offset, section.sh_size)) {
      if (ELF64_ST_TYPE(symbol.st_info) != STT_FUNC || symbol.st_size == 0) continue;
      const std::string name = file.c_str() + sections[section.sh_link].sh_offset + symbol.st_name;
      if (std::any_of(names.begin(), names.end(), [&](const std::string& n) { return name.find(n) != std::string::npos; }))
        out.push_back({base + symbol.st_value, base + symbol.st_value + symbol.st_size});
    }
  }
  std::sort(out.begin(), out.end(), [](const Code& a, const Code& b) { return a.begin < b.begin; });
  return out;
}

#if defined(__x86_64__) && defined(__linux__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)

namespace {

Instructions counted;
Code program;
const std::vector<Code>* watched = nullptr;

void behind_an_instruction(int, siginfo_t*, void* context) {
  const auto at = static_cast<std::uintptr_t>(static_cast<ucontext_t*>(context)->uc_mcontext.gregs[REG_RIP]);
  if (at < program.begin || at >= program.end) return;
  ++counted.all;
  const auto next = std::upper_bound(watched->begin(), watched->end(), at, [](std::uintptr_t x, const Code& c) { return x < c.begin; });
  counted.inside += next != watched->begin() && at < std::prev(next)->end;
}

// Below the 128 bytes that a function may use without asking.
inline void trap_on() { asm volatile("lea -128(%%rsp), %%rsp; pushfq; orq $0x100, (%%rsp); popfq; lea 128(%%rsp), %%rsp" ::: "memory", "cc"); }
inline void trap_off() { asm volatile("lea -128(%%rsp), %%rsp; pushfq; andq $~0x100, (%%rsp); popfq; lea 128(%%rsp), %%rsp" ::: "memory", "cc"); }

}  // namespace

Instructions count_instructions(const std::function<void()>& f, const std::vector<Code>& code) {
  struct sigaction trap {}, before {};
  trap.sa_sigaction = behind_an_instruction;
  trap.sa_flags = SA_SIGINFO;
  counted = {};
  program = loaded().code;
  watched = &code;
  sigaction(SIGTRAP, &trap, &before);
  trap_on();
  f();
  trap_off();
  sigaction(SIGTRAP, &before, nullptr);
  return counted;
}

#else

Instructions count_instructions(const std::function<void()>& f, const std::vector<Code>&) {
  f();
  return {};
}

#endif

bool can_count_instructions() {
  volatile int x = 0;
  return count_instructions([&] { for (int k = 0; k < 100; ++k) x = x + 1; }).all > 300;
}

}  // namespace delassus
