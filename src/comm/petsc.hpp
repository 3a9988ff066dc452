/// What PETSc is told, and what it says when it fails.
#pragma once
#include <string>
#include <string_view>

namespace packmpi::comm {

/// Throws Error(numerical_failure) "PETSc failed to WHAT: its words" if `code` is not 0. PETSc itself prints nothing.
/// Local.
void check_petsc(int code, std::string_view what);

/// What is wrong with options in PETSc's own words, "" if nothing is. A scene is a stranger's: it may choose solvers
/// and tolerances and ask for reports on the terminal, but name no file and load no code. So only options of SNES, KSP,
/// PC and PetscSF are taken, with numbers and plain words, and -log_view and -options_left without a value. Local.
[[nodiscard]] std::string petsc_options_flaw(const std::string& words);

/// Adds options in PETSc's own words, for example "-snes_rtol 1e-9". Needs a Session. The same words on every rank.
/// Errors: Error(bad_input) with petsc_options_flaw() or PETSc's reason. Local.
void petsc_options(const std::string& words);

/// All options that PETSc has, as one line, whoever gave them; "" if it has none. Needs a Session. Local.
[[nodiscard]] std::string petsc_options_in_use();

}  // namespace packmpi::comm
