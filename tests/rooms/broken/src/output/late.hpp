#pragma once
#include <CLI/CLI.hpp>
#include <H5Cpp.h>
#include <hdf5.h>
#include <petscviewerhdf5.h>

#include "scene/late.hpp"
