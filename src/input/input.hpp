/// The structs of a scene, by the name that most files know.
#pragma once
#include "config/input.hpp"
