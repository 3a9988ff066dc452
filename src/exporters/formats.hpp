/// The formats there are: the one table for the command line, the documentation and the writing. Private to this
/// module.
#pragma once
#include <span>

#include "exporters/convert.hpp"
#include "exporters/document.hpp"
#include "exporters/springs.hpp"

namespace packmpi::exporters {

struct Format {
  FormatWords words;
  Document (*make)(const Specimen&);
  SpringsBy springs = SpringsBy::none;
};
[[nodiscard]] std::span<const Format> formats();

}  // namespace packmpi::exporters
