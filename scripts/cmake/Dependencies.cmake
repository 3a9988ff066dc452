# Every library packmpi stands on, as imported targets. Debian 12 names and traps: see scripts/setup.sh.
set(MPI_CXX_SKIP_MPICXX ON)   # the C interface only
find_package(MPI 3.1 REQUIRED COMPONENTS C CXX)

find_package(PkgConfig REQUIRED)
if(PACKMPI_PETSC64)
  pkg_check_modules(PETSC REQUIRED IMPORTED_TARGET PETSc64>=3.18)
else()
  pkg_check_modules(PETSC REQUIRED IMPORTED_TARGET PETSc>=3.18)
endif()

set(HDF5_PREFER_PARALLEL ON)
find_package(HDF5 1.10.2 REQUIRED COMPONENTS C)
if(NOT HDF5_IS_PARALLEL)
  message(FATAL_ERROR "packmpi needs a parallel HDF5 (Debian: libhdf5-openmpi-dev)")
endif()

find_path(METIS_INCLUDE_DIR metis.h REQUIRED)   # Debian ships neither a .pc nor a config file
find_library(METIS_LIBRARY metis REQUIRED)
add_library(METIS::METIS UNKNOWN IMPORTED)
set_target_properties(METIS::METIS PROPERTIES
  IMPORTED_LOCATION "${METIS_LIBRARY}" INTERFACE_INCLUDE_DIRECTORIES "${METIS_INCLUDE_DIR}")

find_path(VORO_INCLUDE_DIR voro++/voro++.hh REQUIRED)   # as METIS
find_library(VORO_LIBRARY voro++ REQUIRED)
add_library(voro::voro UNKNOWN IMPORTED)
set_target_properties(voro::voro PROPERTIES
  IMPORTED_LOCATION "${VORO_LIBRARY}" INTERFACE_INCLUDE_DIRECTORIES "${VORO_INCLUDE_DIR}")

find_package(Boost 1.74 REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(tomlplusplus 3.3 REQUIRED CONFIG)
find_package(CLI11 2.1 REQUIRED CONFIG)
find_package(fmt 9 REQUIRED CONFIG)
find_package(spdlog 1.10 REQUIRED CONFIG)
find_package(nlohmann_json 3.11 REQUIRED CONFIG)
find_path(RANDOM123_INCLUDE_DIR Random123/philox.h REQUIRED)

# Private to the library: none of these is seen in include/.
add_library(packmpi_private_libraries INTERFACE)
target_link_libraries(packmpi_private_libraries INTERFACE PkgConfig::PETSC hdf5::hdf5 METIS::METIS voro::voro Boost::headers Eigen3::Eigen
  tomlplusplus::tomlplusplus CLI11::CLI11 fmt::fmt spdlog::spdlog nlohmann_json::nlohmann_json)
target_include_directories(packmpi_private_libraries SYSTEM INTERFACE ${RANDOM123_INCLUDE_DIR})
