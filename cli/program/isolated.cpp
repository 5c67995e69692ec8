#include "cli/program/isolated.h"

#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <stdexcept>

namespace delassus {
namespace {

void write_all(int to, const std::string& text) {
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t n = ::write(to, text.data() + done, text.size() - done);
    if (n < 0 && errno != EINTR) return;
    if (n > 0) done += static_cast<std::size_t>(n);
  }
}

/// The child: never returns.
[[noreturn]] void serve(const std::function<std::string(const Progress&)>& work, int to, std::FILE* said) {
  ::dup2(::fileno(said), STDOUT_FILENO);
  ::dup2(::fileno(said), STDERR_FILENO);
  int code = 0;
  try {
    write_all(to, work([to](const std::string& part) { write_all(to, part); }));
  } catch (const std::exception& e) {
    write_all(STDERR_FILENO, std::string("exception: ") + e.what());
    code = 3;
  } catch (...) {
    write_all(STDERR_FILENO, "an exception of unknown type");
    code = 3;
  }
  ::_exit(code);
}

/// Reads to the end of the pipe, or to the time limit; false: time is up.
bool read_all(int from, double seconds, std::string& out) {
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  char buffer[65536];
  while (true) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now()).count();
    if (left <= 0) return false;
    pollfd wait{from, POLLIN, 0};
    const int ready = ::poll(&wait, 1, static_cast<int>(left));
    if (ready == 0) return false;
    if (ready < 0) {
      if (errno == EINTR) continue;
      return false;
    }
    const ssize_t n = ::read(from, buffer, sizeof buffer);
    if (n == 0) return true;
    if (n > 0) out.append(buffer, static_cast<std::size_t>(n));
    else if (errno != EINTR) return true;
  }
}

std::string tail(std::FILE* file, long most) {
  std::fseek(file, 0, SEEK_END);
  const long size = std::ftell(file);
  std::fseek(file, size > most ? -most : -size, SEEK_END);
  std::string text(static_cast<std::size_t>(size > most ? most : size), '\0');
  text.resize(std::fread(text.data(), 1, text.size(), file));
  return text;
}

}  // namespace

Outcome isolated(const std::function<std::string(const Progress&)>& work, double seconds) {
  int ends[2];
  std::FILE* said = std::tmpfile();
  if (said == nullptr || ::pipe(ends) != 0) throw std::runtime_error("no pipe or temporary file for a child process");
  std::fflush(nullptr);
  const pid_t child = ::fork();
  if (child < 0) throw std::runtime_error("no child process can be had");
  if (child == 0) {
    ::close(ends[0]);
    serve(work, ends[1], said);
  }
  ::close(ends[1]);
  Outcome out;
  if (!read_all(ends[0], seconds, out.result)) {
    out.end = Outcome::End::timed_out;
    ::kill(child, SIGKILL);
  }
  ::close(ends[0]);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {}
  if (out.end != Outcome::End::timed_out && !(WIFEXITED(status) && WEXITSTATUS(status) == 0)) {
    out.end = Outcome::End::crashed;
    out.signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  }
  out.said = tail(said, 4096);
  std::fclose(said);
  return out;
}

std::string describe(const Outcome& o) {
  if (o.end == Outcome::End::returned) return "returned";
  if (o.end == Outcome::End::timed_out) return "no answer within the time limit";
  if (o.signal == 0) return "ended by " + (o.said.empty() ? std::string("itself") : o.said);
  return "signal " + std::to_string(o.signal) + " (" + strsignal(o.signal) + ")";
}

}  // namespace delassus
