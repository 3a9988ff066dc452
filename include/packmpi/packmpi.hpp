/// packmpi as a library: all of its public headers.
#pragma once
#include "packmpi/version.hpp"
