/// What a file of another code consists of. One writer a format makes one from a specimen; the file itself is written
/// by exporters/rows_file. Private to this module.
#pragma once
#include <fmt/format.h>

#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include "exporters/header.hpp"

namespace packmpi::exporters {

using handover::Outgoing;
using handover::Selection;
using handover::Specimen;
using Text = fmt::memory_buffer;

/// Words, then a stretch of bytes for each particle in turn.
struct Section {
  std::string head;
  std::function<void(Text&, const Outgoing&)> row;  ///< appends; a pure function of the particle
};

/// A whole file, and the small one that goes with it.
struct Document {
  std::vector<Section> sections;
  std::string tail;
  std::string companion;  ///< "": none
  std::string third;      ///< a surface of triangles or springs, for codes that read them from a file; "": none
};

/// A value of a raw binary file, little-endian as x86-64 has it.
template <class T>
void append_raw(Text& out, const T& value) {
  const auto* bytes = reinterpret_cast<const char*>(&value);
  out.append(bytes, bytes + sizeof value);
}

// The writers, each in a file and a namespace of its own.
// clang-format off
namespace lammps { Document make(const Specimen& specimen); }
namespace liggghts { Document make(const Specimen& specimen); }
namespace yade { Document make(const Specimen& specimen); }
namespace esys { Document make(const Specimen& specimen); }
namespace mercurydpm { Document make(const Specimen& specimen); }
namespace lethe { Document make(const Specimen& specimen); }
namespace pfc { Document make(const Specimen& specimen); }
namespace xyz { Document make(const Specimen& specimen); }
namespace csv { Document make(const Specimen& specimen); }
namespace vtk { Document make(const Specimen& specimen); }
// clang-format on

}  // namespace packmpi::exporters
