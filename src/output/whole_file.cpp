#include "output/whole_file.hpp"

#include <fmt/format.h>

#include "output/files.hpp"

namespace packmpi::output {
namespace {

constexpr std::int64_t metadata_bytes = 1 << 17;  // headers, groups, attributes

std::int64_t bytes_needed(const std::vector<h5::Column>& plan, std::int64_t frame_bytes) {
  std::int64_t bytes = metadata_bytes + frame_bytes;
  for (const h5::Column& column : plan) {
    bytes += static_cast<std::int64_t>(column.slab.total * column.width * H5Tget_size(column.type.get()));
  }
  return bytes;
}

/// Runs `step`, agreed by all; the system's reason is put before HDF5's words. A step of collective calls is one that
/// fails on its own without keeping the others waiting (hdf5.hpp).
template <class Step>
void together(const comm::Comm& comm, const std::string& path, Step&& step) {
  comm::agree_on(comm, [&] {
    try {
      step();
    } catch (const Error& error) {
      const std::string words = error.what();
      if (words.find(path) != std::string::npos) throw;  // says it all
      const std::string reason = diagnose(path);
      throw Error(error.code(),
                  fmt::format("cannot write {}: {}{}{}", path, reason, reason.empty() ? "" : ": ", words));
    }
  });
}

/// On rank 0: the file with everything but the rows, and the disk space for them. Space is looked for twice, since HDF5
/// gives the first back when it creates the file.
void make_frame(const std::string& path, std::int64_t bytes, const std::function<void(hid_t)>& frame) {
  reserve(path, bytes);
  h5::Handle file = h5::create_file(path);
  frame(file.get());
  file.close("close the file");
  reserve_existing(path, bytes);
}

/// The file under its temporary name.
void write_temporary(const comm::Comm& comm, const std::string& path, const std::vector<h5::Column>& plan,
                     std::int64_t bytes, const std::function<void(hid_t)>& frame) {
  together(comm, path, [&] {
    if (comm.rank() == 0) make_frame(path, bytes, frame);
  });
  h5::Handle file;
  together(comm, path, [&] { file = h5::open_together(comm, path); });
  for (const h5::Column& column : plan) {
    together(comm, path, [&] {
      const h5::Handle dataset(H5Dopen2(file.get(), column.path.c_str(), H5P_DEFAULT), H5Dclose, "open " + column.path);
      h5::write_rows(dataset.get(), column);
    });
  }
  together(comm, path, [&] { file.close("close the file"); });
}

}  // namespace

void write_whole_file(const comm::Comm& comm, const std::string& path, const std::vector<h5::Column>& plan,
                      std::int64_t frame_bytes, const std::function<void(hid_t)>& frame) {
  const h5::Quiet quiet;
  const std::string temporary = path + ".tmp";
  try {
    write_temporary(comm, temporary, plan, bytes_needed(plan, frame_bytes), frame);
    together(comm, path, [&] {
      if (comm.rank() == 0) commit(temporary, path);
    });
  } catch (const Error&) {  // agreed: every rank is here
    comm.barrier();         // the others have let go of the file
    if (comm.rank() == 0) discard(temporary);
    throw;
  }
}

}  // namespace packmpi::output
