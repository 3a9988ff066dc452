# Install the library, the program and find_package(packmpi).
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/packmpi)
configure_package_config_file(scripts/cmake/packmpiConfig.cmake.in packmpiConfig.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(packmpiConfigVersion.cmake COMPATIBILITY SameMinorVersion)

install(TARGETS packmpi EXPORT packmpiTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(EXPORT packmpiTargets NAMESPACE packmpi:: DESTINATION ${package_dir})
install(FILES ${PROJECT_BINARY_DIR}/packmpiConfig.cmake ${PROJECT_BINARY_DIR}/packmpiConfigVersion.cmake
  DESTINATION ${package_dir})
if(NOT BUILD_SHARED_LIBS)
  install(FILES scripts/cmake/Dependencies.cmake DESTINATION ${package_dir})
endif()
install(DIRECTORY include/packmpi DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})

file(RELATIVE_PATH bin_to_lib ${CMAKE_INSTALL_FULL_BINDIR} ${CMAKE_INSTALL_FULL_LIBDIR})
set_target_properties(packmpi_program PROPERTIES INSTALL_RPATH "$ORIGIN/${bin_to_lib}")
install(TARGETS packmpi_program RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})

# The tools in Python: packmpi render, plot, report; and import packmpi.
install(DIRECTORY scripts/python/packmpi DESTINATION ${PACKMPI_PYTHON_DIR} PATTERN __pycache__ EXCLUDE)

# Examples and the documentation, readable as they are.
install(DIRECTORY input/ DESTINATION ${CMAKE_INSTALL_DOCDIR}/input)
install(DIRECTORY doc/ DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES README.md LICENSE CITATION.cff DESTINATION ${CMAKE_INSTALL_DOCDIR})

# Manual page and shell completions, as the installed program prints them.
set(share "\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_DATADIR}")
foreach(page "manual|man/man1/packmpi.1" "completion bash|bash-completion/completions/packmpi"
        "completion zsh|zsh/site-functions/_packmpi" "completion fish|fish/vendor_completions.d/packmpi.fish")
  string(REPLACE "|" ";" page "${page}")
  list(GET page 0 words)
  list(GET page 1 file)
  separate_arguments(words)
  install(CODE "
    set(file \"${share}/${file}\")
    cmake_path(GET file PARENT_PATH folder)
    file(MAKE_DIRECTORY \"\${folder}\")
    execute_process(COMMAND $<TARGET_FILE:packmpi_program> ${words} OUTPUT_FILE \"\${file}\" RESULT_VARIABLE failed ERROR_QUIET)
    if(failed)
      message(WARNING \"\${file} was not written: the program does not start here\")
      file(REMOVE \"\${file}\")
    endif()")
endforeach()
