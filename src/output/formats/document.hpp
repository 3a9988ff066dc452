/// What a file of another code consists of. One writer a format makes one from a specimen; the file itself is written
/// by output/rows_file. Private to this room.
#pragma once
#include <fmt/format.h>

#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include "output/specimen.hpp"

namespace packmpi::output {

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
};

/// A value of a raw binary file, little-endian as x86-64 has it.
template <class T>
void append_raw(Text& out, const T& value) {
  const auto* bytes = reinterpret_cast<const char*>(&value);
  out.append(bytes, bytes + sizeof value);
}

// The writers, by format; in files of their own.
[[nodiscard]] Document lammps_document(const Specimen& specimen);
[[nodiscard]] Document liggghts_document(const Specimen& specimen);
[[nodiscard]] Document yade_document(const Specimen& specimen);
[[nodiscard]] Document esys_document(const Specimen& specimen);
[[nodiscard]] Document mercurydpm_document(const Specimen& specimen);
[[nodiscard]] Document lethe_document(const Specimen& specimen);
[[nodiscard]] Document pfc_document(const Specimen& specimen);
[[nodiscard]] Document xyz_document(const Specimen& specimen);
[[nodiscard]] Document csv_document(const Specimen& specimen);
[[nodiscard]] Document vtk_document(const Specimen& specimen);

}  // namespace packmpi::output
