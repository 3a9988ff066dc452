#pragma once
#include <hdf5.h>
#include <mpi.h>
#include <toml++/toml.h>

#include <span>

#include "base/early.hpp"
#include "packmpi/version.hpp"
