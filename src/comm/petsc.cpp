#include "comm/petsc.hpp"

#include <petscsys.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <vector>

#include "base/error.hpp"
#include "base/text.hpp"

namespace packmpi::comm {
namespace {

std::string reason(PetscErrorCode failure) {
  const char* text = nullptr;
  char* specific = nullptr;
  PetscErrorMessage(failure, &text, &specific);
  if (specific != nullptr && *specific != '\0') return text::printable(specific);
  return text != nullptr ? text : "error " + std::to_string(failure);
}

std::vector<std::string> split(const std::string& words) {
  std::vector<std::string> all;
  for (std::size_t at = 0; (at = words.find_first_not_of(' ', at)) != std::string::npos;) {
    const std::size_t end = std::min(words.find(' ', at), words.size());
    all.push_back(words.substr(at, end - at));
    at = end;
  }
  return all;
}

bool is_number(const std::string& word) {
  char* end = nullptr;
  (void)std::strtod(word.c_str(), &end);
  return !word.empty() && end == word.c_str() + word.size();
}

bool is_option(const std::string& word) { return word.size() > 1 && word[0] == '-' && !is_number(word); }

/// Letters, digits and '_': the name of a method, of nothing on a disk.
bool is_plain(const std::string& word) {
  return std::ranges::all_of(word, [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
  });
}

bool has_any(const std::string& word, std::initializer_list<const char*> parts) {
  return std::ranges::any_of(parts, [&](const char* part) { return word.find(part) != std::string::npos; });
}

/// A report, which goes to the terminal as long as it has no value.
bool is_report(const std::string& option) { return has_any(option, {"view", "monitor", "reason", "log", "left"}); }

/// "implicit_" is the prefix of the implicit steps' solver, "sub_" that of the blocks of its preconditioner.
bool is_known(const std::string& option) {
  constexpr std::array prefixes{"-implicit_snes_", "-implicit_ksp_", "-implicit_pc_", "-implicit_sub_",
                                "-snes_",          "-ksp_",          "-pc_",          "-sf_"};
  const bool named = option == "-log_view" || option == "-options_left";
  const auto begins = [&](const char* prefix) { return option.starts_with(prefix); };
  // What PETSc loads, draws or serves by these is code or a window.
  const bool opens = has_any(option, {"python", "shell", "matlab", "saws", "draw", "plot", "lg", "file", "load"});
  return (named || std::ranges::any_of(prefixes, begins)) && is_plain(option.substr(1)) && !opens;
}

}  // namespace

void check_petsc(int code, std::string_view what) {
  if (code == 0) return;
  throw Error(ExitCode::numerical_failure,
              "PETSc failed to " + std::string(what) + ": " + reason(static_cast<PetscErrorCode>(code)));
}

std::string petsc_options_flaw(const std::string& words) {
  const std::vector<std::string> all = split(words);
  for (std::size_t k = 0; k < all.size(); ++k) {
    const std::string name = text::printable(all[k]);
    if (!is_option(all[k])) return "options start with a '-', unlike \"" + name + "\"";
    if (!is_known(all[k])) {
      return name +
             " is not taken from a scene; there are -implicit_snes_..., -implicit_ksp_..., -implicit_pc_... and "
             "-sf_... that name no file and load nothing, -log_view and -options_left";
    }
    const bool has_value = k + 1 < all.size() && !is_option(all[k + 1]);
    if (!has_value) continue;
    const std::string& value = all[++k];
    if (is_report(name)) return name + " takes no value here: reports go to the terminal";
    const bool loads = has_any(value, {"python", "shell", "matlab"});
    if (loads || !(is_number(value) || is_plain(value))) {
      return name + ": the value must be a number or the name of a method, unlike \"" + text::printable(value) + "\"";
    }
  }
  return "";
}

void petsc_options(const std::string& words) {
  if (const std::string flaw = petsc_options_flaw(words); !flaw.empty()) {
    throw Error(ExitCode::bad_input, "petsc.options: " + flaw);
  }
  const PetscErrorCode failure = PetscOptionsInsertString(nullptr, words.c_str());
  if (failure != 0) {
    throw Error(ExitCode::bad_input, "PETSc refuses the options \"" + words + "\": " + reason(failure));
  }
  // PetscInitialize looks for -log_view once; asked for later, the log must be begun by hand.
  PetscBool wants_log = PETSC_FALSE;
  PetscOptionsHasName(nullptr, nullptr, "-log_view", &wants_log);
  if (wants_log == PETSC_TRUE) PetscLogDefaultBegin();
}

std::string petsc_options_in_use() {
  char* all = nullptr;
  check_petsc(PetscOptionsGetAll(nullptr, &all), "tell its options");
  std::string words = all == nullptr ? "" : text::printable(text::trimmed(all));
  PetscFree(all);
  return words;
}

}  // namespace packmpi::comm
