/// A thin layer below all I/O that makes one call fail, for tests only: a shared library that stands before libc. A
/// test links it; a whole program gets it by LD_PRELOAD and the environment (io_faults.cpp). The program itself knows
/// nothing of it.
#pragma once

namespace packmpi::testing {

/// What the call that fails reports. The first three count opening for writing, writing, reserving, truncating, fsync,
/// renaming and closing; `short_write` only writing; `read_error` opening for reading and reading.
enum class Fault : int { none, no_space, disk_full, io_error, short_write, read_error };  // disk_full: from then on

}  // namespace packmpi::testing

extern "C" {
/// Calls on files below `folder` (a prefix of their path) are counted from now on, and the `call`-th (1 ..) fails; 0:
/// none does. Of this process.
void io_faults_arm(const char* folder, packmpi::testing::Fault fault, long call);
/// Ends it. The number of calls that failed.
long io_faults_disarm();

/// Calls that change files below `folder`, of this process, are written down from now on.
void io_faults_record(const char* folder);
/// Ends it. A line a call, in their order: "write NAME", "fsync NAME", "rename NAME", the names without `folder`; the
/// folder itself is ".". Writing counts whatever changes a file's bytes or size.
const char* io_faults_recorded();
}
