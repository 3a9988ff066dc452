# cmake -P: PACKMPI_TEMPLATE -> PACKMPI_HEADER, with the git id of PACKMPI_SOURCE_DIR, or "unknown" outside a clone.
# A tarball unpacked inside somebody else's clone must not take that clone's id: the top folders are compared.
set(PACKMPI_GIT_ID "unknown")
find_program(GIT_EXECUTABLE git)
if(GIT_EXECUTABLE)
  execute_process(COMMAND ${GIT_EXECUTABLE} rev-parse --show-toplevel WORKING_DIRECTORY ${PACKMPI_SOURCE_DIR}
    OUTPUT_VARIABLE top ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
  file(REAL_PATH "${PACKMPI_SOURCE_DIR}" source)
  if(top STREQUAL source)
    execute_process(COMMAND ${GIT_EXECUTABLE} describe --always --tags --dirty --abbrev=12
      WORKING_DIRECTORY ${PACKMPI_SOURCE_DIR} RESULT_VARIABLE failed OUTPUT_VARIABLE id
      ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
    if(NOT failed)
      set(PACKMPI_GIT_ID "${id}")
    endif()
  endif()
endif()
configure_file(${PACKMPI_TEMPLATE} ${PACKMPI_HEADER} @ONLY)
