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
