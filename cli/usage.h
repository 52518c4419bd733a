#pragma once
#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace grouser::cli {

/// One sentence on what is wrong with the command line that `root` refused, with a "did you mean" where one is near.
[[nodiscard]] std::string explain(const CLI::App& root, const CLI::ParseError& error,
                                  const std::vector<std::string>& arguments);

/// Refuses what is none of `names`, nor a file name ending in `extension` where one is given, with the nearest of them.
[[nodiscard]] CLI::Validator one_of(std::vector<std::string> names, std::string extension = "");

/// Refuses what is no number, or none that can be counted with: nan, inf.
[[nodiscard]] CLI::Validator finite_number();

/// Refuses a file name that does not end in `extension` (".png").
[[nodiscard]] CLI::Validator ending_in(const std::string& extension);

/// The option that was given an empty value, as a script gives whose variable is not set, with what is wrong about it;
/// empty when there is none.
[[nodiscard]] std::string empty_value(const CLI::App& root);

}  // namespace grouser::cli
