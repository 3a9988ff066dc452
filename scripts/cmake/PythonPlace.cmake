# The Python package of render, plot and report (scripts/python/packmpi). Installed where Python 3 of this machine looks below a
# prefix as /usr/local, so that "import packmpi" finds it; in the build folder it stands beside the program, as links to its sources, with its compiled part.
find_program(PACKMPI_PYTHON python3 PATHS /usr/bin NO_DEFAULT_PATH)
set(place share/packmpi/python)
if(PACKMPI_PYTHON)
  execute_process(COMMAND ${PACKMPI_PYTHON} -c "import sys, sysconfig
print('lib/python%d.%d/' % sys.version_info[:2] + sysconfig.get_path('purelib').split('/')[-1])"
    OUTPUT_VARIABLE found RESULT_VARIABLE failed ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(NOT failed)
    set(place ${found})
  endif()
endif()
set(PACKMPI_PYTHON_DIR ${place} CACHE STRING "folder of the installed Python package, below the prefix")
file(RELATIVE_PATH PACKMPI_PYTHON_FROM_PROGRAM /prefix/${CMAKE_INSTALL_BINDIR} /prefix/${PACKMPI_PYTHON_DIR})
if(IS_SYMLINK ${PROJECT_BINARY_DIR}/python)   # as it was before there was a compiled part
  file(REMOVE ${PROJECT_BINARY_DIR}/python)
endif()
file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/python/packmpi)
file(GLOB links ${PROJECT_BINARY_DIR}/python/packmpi/*)
foreach(link IN LISTS links)
  if(IS_SYMLINK ${link})   # the source may be gone
    file(REMOVE ${link})
  endif()
endforeach()
file(GLOB package CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/scripts/python/packmpi/*)
foreach(file IN LISTS package)
  get_filename_component(name ${file} NAME)
  if(NOT name STREQUAL "__pycache__")
    file(CREATE_LINK ${file} ${PROJECT_BINARY_DIR}/python/packmpi/${name} SYMBOLIC)
  endif()
endforeach()
