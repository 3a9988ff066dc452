#pragma once
#include <H5Cpp.h>
#include <hdf5.h>
#include <petscviewerhdf5.h>

#include <CLI/CLI.hpp>

#include "scene/late.hpp"
