/// packmpi as a library: all of its public headers.
#pragma once
#include "packmpi/failure.hpp"
#include "packmpi/library.hpp"
#include "packmpi/make_pack.hpp"
#include "packmpi/packing.hpp"
#include "packmpi/run.hpp"
#include "packmpi/scene.hpp"
#include "packmpi/version.hpp"
