#include "exporters/rows_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>

#include "base/error.hpp"
#include "disk/files.hpp"
#include "disk/scatter.hpp"

namespace packmpi::exporters {
namespace {

constexpr std::size_t flush_bytes = 1 << 20;

/// Writes all of `bytes` at `offset`.
void put(const disk::Descriptor& file, const std::string& path, std::string_view bytes, std::int64_t offset) {
  while (!bytes.empty()) {
    const ssize_t written = ::pwrite(file.get(), bytes.data(), bytes.size(), offset);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) disk::fail(path, "write", written == 0 ? ENOSPC : errno);
    bytes.remove_prefix(static_cast<std::size_t>(written));
    offset += written;
  }
}

/// This rank's particles, with their numbers among all.
void visit_share(const comm::Comm& comm, const Selection& selection, std::int64_t first_index,
                 const std::function<void(const Outgoing&)>& take) {
  const disk::IdBlocks share{selection.places(), comm.size()};
  std::int64_t index = first_index;
  selection.visit(share.begin(comm.rank()), share.begin(comm.rank() + 1), [&](const pack::ParticleRow& row) {
    take({row, index++});
  });
}

/// Where each section's head, and this rank's rows of it, begin in the file.
struct Plan {
  std::int64_t first_index = 0;             ///< of this rank's particles
  std::vector<std::int64_t> mine;           ///< bytes of this rank's rows, by section
  std::vector<std::int64_t> heads, offset;  ///< [bytes from the file's start], by section
  std::int64_t tail = 0, total = 0;
};

std::int64_t count_share(const comm::Comm& comm, const Selection& selection) {
  const disk::IdBlocks share{selection.places(), comm.size()};
  if (!selection.trims()) return share.begin(comm.rank() + 1) - share.begin(comm.rank());
  std::int64_t count = 0;
  comm::agree_on(comm, [&] { visit_share(comm, selection, 0, [&](const Outgoing&) { ++count; }); });
  return count;
}

/// First pass: lengths, and from them the places.
Plan make_plan(const comm::Comm& comm, const Document& document, const Selection& selection) {
  Plan plan;
  plan.first_index = comm.sum_below(count_share(comm, selection));
  plan.mine.resize(document.sections.size());
  comm::agree_on(comm, [&] {
    Text words;
    visit_share(comm, selection, plan.first_index, [&](const Outgoing& particle) {
      for (std::size_t s = 0; s < document.sections.size(); ++s) {
        words.clear();
        document.sections[s].row(words, particle);
        plan.mine[s] += static_cast<std::int64_t>(words.size());
      }
    });
  });
  for (std::size_t s = 0; s < document.sections.size(); ++s) {
    plan.heads.push_back(plan.total);
    const std::int64_t rows = plan.total + static_cast<std::int64_t>(document.sections[s].head.size());
    plan.offset.push_back(rows + comm.sum_below(plan.mine[s]));
    plan.total = rows + comm.sum(plan.mine[s]);
  }
  plan.tail = plan.total;
  plan.total += static_cast<std::int64_t>(document.tail.size());
  return plan;
}

/// Rows of one section on their way to the disk.
struct Stream {
  Text text;
  std::int64_t at = 0;

  void flush(const disk::Descriptor& file, const std::string& path) {
    put(file, path, {text.data(), text.size()}, at);
    at += static_cast<std::int64_t>(text.size());
    text.clear();
  }
};

/// Second pass: this rank's rows.
void write_share(const comm::Comm& comm, const std::string& path, const Document& document, const Selection& selection,
                 const Plan& plan) {
  disk::Descriptor file(path, O_WRONLY);
  std::vector<Stream> streams(document.sections.size());
  for (std::size_t s = 0; s < streams.size(); ++s) streams[s].at = plan.offset[s];
  visit_share(comm, selection, plan.first_index, [&](const Outgoing& particle) {
    for (std::size_t s = 0; s < streams.size(); ++s) {
      document.sections[s].row(streams[s].text, particle);
      if (streams[s].text.size() >= flush_bytes) streams[s].flush(file, path);
    }
  });
  for (std::size_t s = 0; s < streams.size(); ++s) {
    streams[s].flush(file, path);
    if (streams[s].at != plan.offset[s] + plan.mine[s]) {
      throw Error(ExitCode::io_failure, "the pack changed while it was read");
    }
  }
  file.close();
}

/// Heads and tail; by rank 0.
void write_words(const std::string& path, const Document& document, const Plan& plan) {
  disk::Descriptor file(path, O_WRONLY);
  for (std::size_t s = 0; s < document.sections.size(); ++s) put(file, path, document.sections[s].head, plan.heads[s]);
  put(file, path, document.tail, plan.tail);
  file.close();
}

}  // namespace

void write_rows_file(const comm::Comm& comm, const std::string& path, const Document& document,
                     const Selection& selection) {
  const Plan plan = make_plan(comm, document, selection);
  comm::agree_on(comm, [&] {
    if (comm.rank() != 0) return;
    disk::reserve(path, plan.total);
    write_words(path, document, plan);
  });
  comm::agree_on(comm, [&] { write_share(comm, path, document, selection, plan); });
}

}  // namespace packmpi::exporters
