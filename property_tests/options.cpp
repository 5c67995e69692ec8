#include "property_tests/options.h"

#include <charconv>
#include <cmath>
#include <filesystem>
#include <iostream>

namespace delassus::options {
namespace {

/// The number that all of the text is; false: it is none.
template <class T> bool read(const std::string& text, T& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

/// Refuses what `good` does not take, in the words of ModelError.
CLI::Validator accepts(const std::string& what, const std::function<bool(const std::string&)>& good) {
  return {[=](std::string& text) { return good(text) ? std::string() : "is '" + text + "' (accepted: " + what + ")"; }, "", ""};
}

CLI::Validator finite(const std::string& relation, double least, const std::string& unit, bool equal_too) {
  char number[32];
  const auto end = std::to_chars(number, number + sizeof number, least).ptr;
  const std::string what = "a finite number " + relation + " " + std::string(number, end) + (unit.empty() ? "" : " [" + unit + "]");
  return accepts(what, [=](const std::string& text) {
    double x = 0;
    return read(text, x) && std::isfinite(x) && (x > least || (equal_too && x == least));
  });
}

}  // namespace

CLI::Validator at_least(double least, const std::string& unit) { return finite("≥", least, unit, true); }

CLI::Validator above(double least, const std::string& unit) { return finite(">", least, unit, false); }

CLI::Validator whole(std::int64_t least) {
  return accepts("a whole number from " + std::to_string(least) + " to 2⁶³ − 1", [=](const std::string& text) {
    std::int64_t n = 0;
    return read(text, n) && n >= least;
  });
}

void add_shard(CLI::App& app, Shard& shard) {
  const auto take = [&shard](const std::string& text) {
    const std::size_t slash = text.find('/');
    Shard s;
    const bool numbers = slash != std::string::npos && read(text.substr(0, slash), s.number) && read(text.substr(slash + 1), s.of);
    if (!numbers || s.number < 1 || s.number > s.of)
      throw CLI::ValidationError("--shard", "is '" + text + "' (accepted: i/n with 1 ≤ i ≤ n)");
    shard = s;
  };
  app.add_option_function<std::string>("--shard", take, "i/n: every n-th, from the i-th on");
}

int run(CLI::App& app, int argc, char** argv, const std::function<int()>& program) {
  const std::string name = std::filesystem::path(argc > 0 ? argv[0] : "").filename().string();
  try {
    app.parse(argc, argv);
    return program();
  } catch (const CLI::Success& e) {
    return app.exit(e);  // --help
  } catch (const CLI::ParseError& e) {
    std::cerr << name << ": " << e.what() << "\nRun with --help for what is accepted.\n";
  } catch (const std::exception& e) {
    std::cerr << name << ": " << e.what() << '\n';
  }
  return 2;
}

}  // namespace delassus::options
