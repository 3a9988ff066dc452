/// packmpi as a library: all of its public headers.
#pragma once
#include "packmpi/make_pack.hpp"
#include "packmpi/version.hpp"
