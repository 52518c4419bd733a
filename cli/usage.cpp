#include "cli/usage.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "model/findings.h"

namespace grouser::cli {
namespace {

std::string with_hint(const std::string& text, const std::string& word, const std::vector<std::string>& candidates) {
  const std::string hint = did_you_mean(nearest_word(word, candidates));
  return hint.empty() ? text : text + " (" + hint + ")";
}

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

const CLI::App& innermost(const CLI::App& root) {
  const auto chosen = root.get_subcommands();
  return chosen.empty() ? root : *chosen.front();
}

/// "DIR is required: ..." with what DIR is.
std::string missing_argument(const CLI::App& app, const CLI::ParseError& error) {
  const std::string text = error.what();
  for (const CLI::Option* option : app.get_options()) {
    if (text == option->get_name() + " is required") return text + ": " + option->get_description();
  }
  return text;
}

}  // namespace

std::string explain(const CLI::App& root, const CLI::ParseError& error, const std::vector<std::string>& arguments) {
  const CLI::App& app = innermost(root);
  const bool chosen = &app != &root;
  const auto word =
      std::find_if(arguments.begin(), arguments.end(), [](const auto& a) { return a.rfind('-', 0) != 0; });
  if (!chosen && word != arguments.end()) {
    std::vector<std::string> names;
    for (const CLI::App* subcommand : root.get_subcommands(nullptr)) names.push_back(subcommand->get_name());
    return with_hint("unknown subcommand " + *word, *word, names);
  }
  if (const std::vector<std::string> extra = app.remaining(true); !extra.empty()) {
    if (extra.front().rfind('-', 0) != 0) return "unexpected argument " + extra.front();
    const std::string name = extra.front().substr(0, extra.front().find('='));
    return with_hint("unknown option " + name, name, option_names(app));
  }
  return chosen ? missing_argument(app, error) : "expected a subcommand";
}

CLI::Validator one_of(std::vector<std::string> names, std::string extension) {
  return {[names = std::move(names), extension = std::move(extension)](std::string& name) {
            if (std::ranges::find(names, name) != names.end()) return std::string();
            if (!extension.empty() && name.ends_with(extension)) return std::string();
            const std::string or_file = extension.empty() ? "" : " or a file name ending in " + extension;
            return with_hint(fmt::format("expected one of {}{}, found {}", fmt::join(names, ", "), or_file, name), name,
                             names);
          },
          ""};
}

CLI::Validator finite_number() {
  return {[](std::string& text) {
            double value = 0.0;
            const bool right = CLI::detail::lexical_cast(text, value) && std::isfinite(value);
            return right ? std::string() : "expected a finite number, found " + text;
          },
          ""};
}

std::string empty_value(const CLI::App& root) {
  for (const CLI::Option* option : innermost(root).get_options())
    for (const std::string& value : option->results())
      if (value.empty()) return option->get_name() + ": expected a value, found an empty text";
  return "";
}

CLI::Validator ending_in(const std::string& extension) {
  return {[extension](std::string& file) {
            return file.ends_with(extension) ? std::string()
                                             : "expected a file name ending in " + extension + ", found " + file;
          },
          ""};
}

}  // namespace grouser::cli
