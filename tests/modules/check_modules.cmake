# cmake -D ROOT=<checkout> [-D EXPECTED=<file>] -P check_modules.cmake
# Holds src/ and include/ of ROOT to the order of the modules and to the one module that may touch each library.
# With EXPECTED, the violations found must be exactly the lines of that file (the test of this test).
cmake_minimum_required(VERSION 3.25)
file(STRINGS ${ROOT}/src/modules.txt modules REGEX "^[a-z]")

# A third-party header, as it stands between the include's brackets, and the modules that may include it.
set(libraries
  "petsc.*[.]h=comm scene neighbor observe implicit"
  "metis[.]h=scene"
  "hdf5.*[.]h|H5.*[.]h=disk pack"
  "toml[+][+]/.*=document"
  "CLI/.*=cli"
  "Random123/.*=base"
  "Eigen/.*|unsupported/Eigen/.*=geometry implicit"
  "voro[+][+]/.*=observe"
  "boost/.*=report"
  "nlohmann/.*=base report pack run library cli"
  "pybind11/.*=python")

function(report where text)
  set_property(GLOBAL APPEND PROPERTY found "${where}: ${text}")
endfunction()

# The file's lines without comments; characters that mean something in a CMake list are blanked.
function(read_lines file result)
  file(READ ${file} text)
  string(REGEX REPLACE "[][;\\]" " " text "${text}")
  string(REGEX REPLACE "//[^\n]*" "" text "${text}")
  string(REGEX REPLACE "/\\*([^*\n]|\\*+[^*/\n])*\\*+/" "" text "${text}")
  string(REPLACE "\n" ";" lines "${text}")
  set(${result} "${lines}" PARENT_SCOPE)
endfunction()

# "module/file.hpp" seen from `module`: an earlier module or its own, and the file exists.
function(check_own_include where module place name)
  if("${name}" MATCHES "^packmpi/")
    set(target ${ROOT}/include/${name})
  else()
    set(target ${ROOT}/src/${name})
    string(REGEX REPLACE "/.*" "" other "${name}")
    list(FIND modules "${other}" other_place)
    if("${name}" STREQUAL "packmpi_version.hpp" AND "${module}" STREQUAL "base")
      set(target ${ROOT})   # generated
    elseif(other_place EQUAL -1)
      report("${where}" "includes \"${name}\", which is in no module")
      set(target ${ROOT})
    elseif(other_place GREATER place)
      report("${where}" "includes \"${name}\": ${other} comes after ${module}")
    endif()
  endif()
  if(NOT EXISTS ${target})
    report("${where}" "includes \"${name}\", which does not exist")
  endif()
endfunction()

function(check_library_include where module name)
  foreach(rule IN LISTS libraries)
    string(REGEX MATCH "^(.*)=([a-z ]*)$" _ "${rule}")
    set(pattern "${CMAKE_MATCH_1}")
    set(names "${CMAKE_MATCH_2}")
    string(REPLACE " " ";" allowed "${names}")
    if("${name}" MATCHES "^(${pattern})$" AND NOT "${module}" IN_LIST allowed)
      report("${where}" "includes <${name}>, which belongs to: ${names}")
    endif()
  endforeach()
endfunction()

function(check_mpi where module file line)
  string(REGEX REPLACE "\"[^\"]*\"" "" code "${line}")
  if("${code}" MATCHES "P?MPI_[A-Z][a-z][A-Za-z_0-9]* *\\(" AND NOT "${module}" STREQUAL "comm")
    report("${where}" "calls MPI, which belongs to: comm")
  endif()
  if("${code}" MATCHES "MPI_COMM_WORLD" AND NOT "${file}" MATCHES "^src/(main|comm/session)\\.cpp$")
    report("${where}" "names MPI_COMM_WORLD")
  endif()
endfunction()

function(check_line where module place file line)
  if("${line}" MATCHES "^ *# *include *\"([^\"]*)\"")
    check_own_include("${where}" "${module}" ${place} "${CMAKE_MATCH_1}")
  elseif("${line}" MATCHES "^ *# *include *<([^>]*)>")
    check_library_include("${where}" "${module}" "${CMAKE_MATCH_1}")
  elseif("${line}" MATCHES "MPI_")
    check_mpi("${where}" "${module}" "${file}" "${line}")
  endif()
endfunction()

# include/ is seen by other programs: the standard library, MPI and itself, nothing else.
function(check_public_line where line)
  string(REGEX MATCH "^ *# *include *([<\"].*[>\"])" _ "${line}")
  set(name "${CMAKE_MATCH_1}")
  if(NOT "${name}" MATCHES "^(|<[a-z_]+>|<mpi[.]h>|\"packmpi/[a-z_/]*[.]hpp\")$")
    report("${where}" "shows ${name} to the users of the library")
  endif()
endfunction()

list(LENGTH modules place_of_main)
file(GLOB_RECURSE files RELATIVE ${ROOT} ${ROOT}/src/* ${ROOT}/include/*)
list(FILTER files EXCLUDE REGEX "CMakeLists\\.txt$|^src/modules\\.txt$")
list(SORT files)
foreach(file IN LISTS files)
  string(REGEX REPLACE "^src/([^/]*)/.*" "\\1" module "${file}")
  list(FIND modules "${module}" place)
  if("${file}" STREQUAL "src/main.cpp")
    set(place ${place_of_main})
  elseif("${file}" MATCHES "^src/" AND place EQUAL -1)
    report("${file}" "is in no module")
  endif()
  read_lines(${ROOT}/${file} lines)
  set(number 0)
  foreach(line IN LISTS lines)
    math(EXPR number "${number} + 1")
    if("${file}" MATCHES "^include/")
      check_public_line("${file}:${number}" "${line}")
    elseif("${line}" MATCHES "#|MPI_")
      check_line("${file}:${number}" "${module}" ${place} "${file}" "${line}")
    endif()
  endforeach()
endforeach()

list(LENGTH files count)
get_property(found GLOBAL PROPERTY found)
list(JOIN found "\n" text)
if(EXPECTED)
  file(READ ${EXPECTED} expected)
  string(STRIP "${expected}" expected)
  if(NOT "${text}" STREQUAL "${expected}")
    message("expected\n${expected}\nfound\n${text}")
    message(FATAL_ERROR "the violations found are not the expected ones")
  endif()
elseif(found)
  message("${text}")
  message(FATAL_ERROR "the order of the modules (src/modules.txt) is broken")
elseif(count LESS 10)
  message(FATAL_ERROR "only ${count} files under ${ROOT}: nothing was checked")
endif()
message(STATUS "${count} files checked")
