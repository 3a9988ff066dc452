/// A file of many rows that all ranks write, each its own bytes. Private to this module.
#pragma once
#include <string>

#include "comm/comm.hpp"
#include "exporters/document.hpp"

namespace packmpi::exporters {

/// Collective. Writes `document` with the rows of `selection` to PATH, which is not flushed yet and not renamed; disk
/// space is looked for first. Each rank makes its share of the rows twice: to count bytes, and to write them behind
/// those of the ranks before it. Memory: a buffer of a megabyte a section. Throws Error(io_failure) on all ranks; the
/// caller removes PATH then.
void write_rows_file(const comm::Comm& comm, const std::string& path, const Document& document,
                     const Selection& selection);

}  // namespace packmpi::exporters
