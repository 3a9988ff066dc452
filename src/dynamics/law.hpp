/// The law, by the name that most files know.
#pragma once
#include "law/law.hpp"
