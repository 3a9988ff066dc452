# The version header is written anew at each build (and touched only when it changes): a commit between two builds
# must show in the provenance of the next pack, without a new configure.
set(version_command ${CMAKE_COMMAND}
  -D PACKMPI_SOURCE_DIR=${PROJECT_SOURCE_DIR}
  -D PACKMPI_TEMPLATE=${PROJECT_SOURCE_DIR}/src/base/version.hpp.in
  -D PACKMPI_HEADER=${PROJECT_BINARY_DIR}/generated/packmpi_version.hpp
  -D PACKMPI_VERSION=${PROJECT_VERSION}
  "-DPACKMPI_COMPILER=${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION}"
  -P ${PROJECT_SOURCE_DIR}/scripts/cmake/WriteVersion.cmake)
add_custom_target(packmpi_version_header BYPRODUCTS ${PROJECT_BINARY_DIR}/generated/packmpi_version.hpp
  COMMAND ${version_command} COMMENT "" VERBATIM)
add_dependencies(packmpi packmpi_version_header)
execute_process(COMMAND ${version_command} COMMAND_ERROR_IS_FATAL ANY)   # tools that read the sources before a build
