#include "property_tests/options.h"

#include <charconv>
#include <cmath>
#include <deque>
#include <filesystem>
#include <iostream>

#include <CLI/CLI.hpp>

namespace delassus::options {
namespace {

/// The number that all of the text is; false: it is none.
template <class T> bool read(const std::string& text, T& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

/// Refuses what `good` does not take, in the words of ModelError.
Check accepts(const std::string& what, const std::function<bool(const std::string&)>& good) {
  return [=](const std::string& text) { return good(text) ? std::string() : "is '" + text + "' (accepted: " + what + ")"; };
}

Check finite(const std::string& relation, double least, const std::string& unit, bool equal_too) {
  char number[32];
  const auto end = std::to_chars(number, number + sizeof number, least).ptr;
  const std::string what = "a finite number " + relation + " " + std::string(number, end) + (unit.empty() ? "" : " [" + unit + "]");
  return accepts(what, [=](const std::string& text) {
    double x = 0;
    return read(text, x) && std::isfinite(x) && (x > least || (equal_too && x == least));
  });
}

CLI::Option& of(void* option) { return *static_cast<CLI::Option*>(option); }

}  // namespace

Check at_least(double least, const std::string& unit) { return finite("≥", least, unit, true); }

Check above(double least, const std::string& unit) { return finite(">", least, unit, false); }

Check whole(std::int64_t least) {
  return accepts("a whole number from " + std::to_string(least) + " to 2⁶³ − 1", [=](const std::string& text) {
    std::int64_t n = 0;
    return read(text, n) && n >= least;
  });
}

Check one_of(const std::vector<std::string>& words) {
  std::string all;
  for (const std::string& w : words) all += (all.empty() ? "" : ", ") + w;
  return accepts(all, [=](const std::string& text) { return std::find(words.begin(), words.end(), text) != words.end(); });
}

Check existing_file() {
  return accepts("an existing file", [](const std::string& text) { std::error_code e; return std::filesystem::is_regular_file(text, e); });
}

Check existing_directory() {
  return accepts("an existing directory", [](const std::string& text) { std::error_code e; return std::filesystem::is_directory(text, e); });
}

Option* Option::check(const Check& good) {
  of(option_).check(CLI::Validator([good](std::string& text) { return good(text); }, "", ""));
  return this;
}
Option* Option::required() { return of(option_).required(), this; }
Option* Option::needs(const Option* other) { return of(option_).needs(&of(other->option_)), this; }
Option* Option::excludes(const Option* other) { return of(option_).excludes(&of(other->option_)), this; }
Option* Option::capture_default_str() { return of(option_).capture_default_str(), this; }
std::size_t Option::count() const { return of(option_).count(); }

struct Command::Parts {
  std::unique_ptr<CLI::App> own;
  CLI::App* app;
  std::deque<Option> options;
  std::deque<Command> commands;
  Option* keep(CLI::Option* option) { return &options.emplace_back(option); }
};

Command::Command(const std::string& what) : parts_(std::make_unique<Parts>()) {
  parts_->own = std::make_unique<CLI::App>(what);
  parts_->app = parts_->own.get();
}
Command::Command(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
Command::Command(Command&&) noexcept = default;
Command::~Command() = default;

Command* Command::add_subcommand(const std::string& name, const std::string& what) {
  auto parts = std::make_unique<Parts>();
  parts->app = parts_->app->add_subcommand(name, what);
  parts_->commands.push_back(Command(std::move(parts)));
  return &parts_->commands.back();
}

#define DELASSUS_OPTION(T)                                                                        \
  Option* Command::add_option(const std::string& name, T& value, const std::string& help) {       \
    return parts_->keep(parts_->app->add_option(name, value, help));                              \
  }
DELASSUS_OPTION(std::string)
DELASSUS_OPTION(double)
DELASSUS_OPTION(std::int64_t)
DELASSUS_OPTION(std::uint64_t)
DELASSUS_OPTION(std::optional<double>)
DELASSUS_OPTION(std::optional<std::uint64_t>)
DELASSUS_OPTION(std::optional<std::string>)
DELASSUS_OPTION(std::vector<std::string>)
DELASSUS_OPTION(std::vector<double>)
#undef DELASSUS_OPTION

Option* Command::add_flag(const std::string& name, bool& value, const std::string& help) {
  return parts_->keep(parts_->app->add_flag(name, value, help));
}

Option* Command::add_option_function(const std::string& name, const std::function<void(const std::string&)>& take, const std::string& help) {
  const std::function<void(const std::string&)> guarded = [=](const std::string& text) {
    try {
      take(text);
    } catch (const std::invalid_argument& e) {
      throw CLI::ValidationError(name, e.what());
    }
  };
  return parts_->keep(parts_->app->add_option_function<std::string>(name, guarded, help));
}

void Command::footer(const std::string& text) { parts_->app->footer(text); }
void Command::callback(const std::function<void()>& chosen) { parts_->app->callback(chosen); }
void Command::require_subcommand() { parts_->app->require_subcommand(1); }

std::vector<std::string> Command::subcommands() const {
  std::vector<std::string> names;
  for (const CLI::App* c : parts_->app->get_subcommands([](const CLI::App*) { return true; })) names.push_back(c->get_name());
  return names;
}

std::optional<int> Command::parse(int argc, char** argv, std::string& error) {
  try {
    parts_->app->parse(argc, argv);
    return std::nullopt;
  } catch (const CLI::Success& e) {
    return parts_->app->exit(e);  // --help
  } catch (const CLI::ParseError& e) {
    error = std::string(e.what()) + "\nRun with --help for what is accepted.";
    return 2;
  }
}

void add_shard(Command& app, Shard& shard) {
  const auto take = [&shard](const std::string& text) {
    const std::size_t slash = text.find('/');
    Shard s;
    const bool numbers = slash != std::string::npos && read(text.substr(0, slash), s.number) && read(text.substr(slash + 1), s.of);
    if (!numbers || s.number < 1 || s.number > s.of)
      throw std::invalid_argument("is '" + text + "' (accepted: i/n with 1 ≤ i ≤ n)");
    shard = s;
  };
  app.add_option_function("--shard", take, "i/n: every n-th, from the i-th on");
}

int run(Command& app, int argc, char** argv, const std::function<int()>& program) {
  const std::string name = std::filesystem::path(argc > 0 ? argv[0] : "").filename().string();
  try {
    std::string error;
    const std::optional<int> exit = app.parse(argc, argv, error);
    if (!exit) return program();
    if (*exit != 0) std::cerr << name << ": " << error << '\n';
    return *exit;
  } catch (const std::exception& e) {
    std::cerr << name << ": " << e.what() << '\n';
  }
  return 2;
}

}  // namespace delassus::options
