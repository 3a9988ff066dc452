#include "output/whole_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "output/files.hpp"

namespace packmpi::output {
namespace {

/// Where each column's rows begin in the file [bytes].
using Places = std::vector<std::int64_t>;

std::int64_t bytes_of_rows(const std::vector<h5::Column>& plan) {
  std::int64_t bytes = 0;
  for (const h5::Column& column : plan) bytes += static_cast<std::int64_t>(column.slab.total * h5::row_bytes(column));
  return bytes;
}

/// Runs `step`, agreed by all; words that do not say where are given the path.
template <class Step>
void together(const comm::Comm& comm, const std::string& path, Step&& step) {
  comm::agree_on(comm, [&] {
    try {
      step();
    } catch (const Error& error) {
      const std::string words = error.what();
      if (words.find(path) != std::string::npos) throw;
      throw Error(error.code(), fmt::format("cannot write {}: {}", path, words));
    }
  });
}

/// On rank 0: the file with everything but the rows, and the disk space for them. HDF5 makes it in memory, where the
/// rows are a hole.
Places make_frame(const std::string& path, const std::vector<h5::Column>& plan,
                  const std::function<void(hid_t)>& frame) {
  reserve(path, bytes_of_rows(plan));
  const MemoryFile memory(path);
  h5::Handle file = h5::create_file(path, memory);
  frame(file.get());
  Places places;
  for (const h5::Column& column : plan) places.push_back(h5::place_of(file.get(), column));
  file.close("close the file");
  Descriptor disk(path, O_WRONLY);
  memory.copy_to(disk);
  disk.close();
  return places;
}

/// This rank's rows, down to the disk.
void write_rows(const std::string& path, const std::vector<h5::Column>& plan, const Places& places) {
  Descriptor disk(path, O_WRONLY);
  for (std::size_t k = 0; k < plan.size(); ++k) {
    if (plan[k].slab.count == 0) continue;
    const auto before = static_cast<std::int64_t>(plan[k].slab.offset * h5::row_bytes(plan[k]));
    disk.write_at(plan[k].bytes(), places[k] + before);
  }
  disk.sync();
  disk.close();
}

/// The file under its temporary name.
void write_temporary(const comm::Comm& comm, const std::string& path, const std::vector<h5::Column>& plan,
                     const std::function<void(hid_t)>& frame) {
  Places places(plan.size());
  together(comm, path, [&] {
    if (comm.rank() == 0) places = make_frame(path, plan, frame);
  });
  const std::size_t size = places.size() * sizeof places[0];
  const std::string shared = comm.broadcast(0, {reinterpret_cast<const char*>(places.data()), size});
  if (size > 0) std::memcpy(places.data(), shared.data(), size);
  together(comm, path, [&] { write_rows(path, plan, places); });
}

}  // namespace

void write_whole_file(const comm::Comm& comm, const std::string& path, const std::vector<h5::Column>& plan,
                      const std::function<void(hid_t)>& frame) {
  const h5::Quiet quiet;
  const std::string temporary = path + ".tmp";
  try {
    write_temporary(comm, temporary, plan, frame);
    together(comm, path, [&] {
      if (comm.rank() == 0) commit(temporary, path);
    });
  } catch (const Error&) {  // agreed: every rank is here, and has let go of the file
    if (comm.rank() == 0) discard(temporary);
    throw;
  }
}

std::int64_t whole_file_bytes(const std::function<void(hid_t)>& frame) {
  const h5::Quiet quiet;
  std::error_code ignored;
  std::string name = (std::filesystem::temp_directory_path(ignored) / "packmpi-XXXXXX").string();
  const int taken = mkstemp(name.data());  // HDF5 wants a file that nobody else has locked
  if (taken < 0) fail(name, "take a name", errno);
  ::close(taken);
  const MemoryFile memory(name);
  h5::Handle file;
  try {
    file = h5::create_file(name, memory);
  } catch (...) {
    discard(name);
    throw;
  }
  discard(name);
  frame(file.get());
  file.close("close the file");
  return memory.size();
}

}  // namespace packmpi::output
