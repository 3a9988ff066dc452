#include "packmpi/version.hpp"

#include "packmpi_version.hpp"

namespace packmpi {

std::string_view version() noexcept { return PACKMPI_VERSION; }
std::string_view git_id() noexcept { return PACKMPI_GIT_ID; }
std::string_view compiler() noexcept { return PACKMPI_COMPILER; }

}  // namespace packmpi
