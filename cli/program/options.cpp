#include "cli/program/options.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <deque>
#include <filesystem>
#include <iostream>

#include <CLI/CLI.hpp>

#include "algorithms/errors/closest.h"
#include "algorithms/errors/message.h"

namespace delassus::options {
namespace {

/// The whole number that all of the text is; false: it is none.
template <class T> bool read(const std::string& text, T& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

/// Numbers as files have them, less the blanks around.
std::optional<double> number(const std::string& text) {
  return text.find_first_of(" \t\r\n") == std::string::npos ? finite_number(text) : std::nullopt;
}

/// Refuses what `good` does not take, in the words of ModelError.
Check accepts(const std::string& what, const std::function<bool(const std::string&)>& good) {
  return [=](const std::string& text) { return good(text) ? std::string() : "is '" + text + "' (accepted: " + what + ")"; };
}

/// What to do about a text that is refused.
std::string advice(const std::string& text) { return number(text) ? "leave the option away for its default" : not_a_number(text).advice; }

Check finite(const std::string& relation, double least, const std::string& unit, bool equal_too, bool infinite_too = false) {
  const std::string what = std::string(infinite_too ? "" : "finite ") + "number " + relation + " " + number_text(least) + (unit.empty() ? "" : " [" + unit + "]") +
                           (infinite_too ? ", or inf" : "");
  return [=](const std::string& text) {
    if (infinite_too && text == "inf") return std::string();
    const auto x = number(text);
    if (x && (*x > least || (equal_too && *x == least))) return std::string();
    return "is '" + text + "' (accepted: a " + what + "; " + advice(text) + ")";
  };
}

/// ` (did you mean --damping?)` of the first option left over, by those of the subcommand that was given.
std::string meant(const CLI::App& app) {
  const CLI::App* last = &app;
  while (!last->get_subcommands().empty()) last = last->get_subcommands().front();
  std::vector<std::string> names;
  for (const CLI::Option* option : last->get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  for (const CLI::App* at : {last, &app})
    for (const std::string& word : at->remaining()) {
      const std::string answer = did_you_mean(word.substr(0, word.find('=')), names);
      if (!answer.empty()) return " (" + answer.substr(0, answer.size() - 1) + ")";
    }
  return {};
}

CLI::Option& of(void* option) { return *static_cast<CLI::Option*>(option); }

}  // namespace

Check at_least(double least, const std::string& unit) { return finite("≥", least, unit, true); }

Check any_number(const std::string& unit) {
  return [=](const std::string& text) {
    return number(text) ? std::string() : "is '" + text + "' (accepted: a finite number [" + unit + "]; " + advice(text) + ")";
  };
}

Check at_least_or_inf(double least, const std::string& unit) { return finite("≥", least, unit, true, true); }

Check above(double least, const std::string& unit) { return finite(">", least, unit, false); }

double seconds_of(const std::string& text) {
  constexpr std::string_view units = "smh";
  const std::size_t unit = text.empty() ? std::string_view::npos : units.find(text.back());
  const bool has_unit = unit != std::string_view::npos;
  const auto x = number(has_unit ? text.substr(0, text.size() - 1) : text);
  const double seconds = x ? *x * (unit == 1 ? 60 : unit == 2 ? 3600 : 1) : 0;
  return seconds > 0 && seconds <= 1e9 ? seconds : std::nan("");  // a clock counts no more
}

Check duration() {
  return accepts("a number of seconds > 0 up to 1e9, or one with s, m or h behind it; 60, 60s, 10m, 2h", [](const std::string& text) { return !std::isnan(seconds_of(text)); });
}

Check whole(std::int64_t least) {
  return accepts("a whole number from " + std::to_string(least) + " to 2⁶³ − 1; write digits alone", [=](const std::string& text) {
    std::int64_t n = 0;
    return read(text, n) && n >= least;
  });
}

Check one_of(const std::vector<std::string>& words) {
  std::string all;
  for (const std::string& w : words) all += (all.empty() ? "" : ", ") + w;
  return [=](const std::string& text) {
    if (std::find(words.begin(), words.end(), text) != words.end()) return std::string();
    return "is '" + text + "' (accepted: " + did_you_mean(text, words) + all + "; write one of these words)";
  };
}

Check existing_file() {
  return accepts("an existing file; check the path", [](const std::string& text) { std::error_code e; return std::filesystem::is_regular_file(text, e); });
}

Check existing_directory() {
  return accepts("an existing directory; make it first", [](const std::string& text) { std::error_code e; return std::filesystem::is_directory(text, e); });
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
  } catch (const CLI::ExtrasError& e) {
    error = e.what() + meant(*parts_->app) + "\nRun with --help for what is accepted.";
    return 2;
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
      throw std::invalid_argument("is '" + text + "' (accepted: i/n with 1 ≤ i ≤ n; 1/4 is the first of four)");
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
