/// The manual page and the shell completions, made from the declarations of the command line.
#pragma once
#include <string>
#include <string_view>

namespace packmpi::cli {

/// packmpi.1 in troff. Local.
[[nodiscard]] std::string manual_page();

/// The completion script for "bash", "zsh" or "fish". Local.
[[nodiscard]] std::string completion(std::string_view shell);

}  // namespace packmpi::cli
