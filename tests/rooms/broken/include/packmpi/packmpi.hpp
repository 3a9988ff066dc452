#pragma once
#include <hdf5.h>
#include <mpi.h>

#include <span>
#include <toml++/toml.h>

#include "base/early.hpp"
#include "packmpi/version.hpp"
