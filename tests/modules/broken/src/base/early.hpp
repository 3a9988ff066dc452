#pragma once
#include <vector>

#include "base/missing.hpp"
#include "comm/door.hpp"
#include "packmpi_version.hpp"
// #include "output/late.hpp" in a comment is nobody's business
