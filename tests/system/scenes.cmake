# Every scene of input/, scaled down, on one and two ranks; and every exit code.
set(input ${PROJECT_SOURCE_DIR}/input)
set(short --set layers.duration=0.005 --set layers.maximum=2 --set rest.wait=0 --set output.log_every=0.005)
file(GLOB scenes CONFIGURE_DEPENDS ${input}/*.toml)
foreach(scene IN LISTS scenes)
  get_filename_component(name ${scene} NAME_WE)
  set(labels)
  set(smaller)
  if(name STREQUAL "concrete")   # nothing moves, and all of it is there in a second
    packmpi_system_test(scene_concrete RANKS 2 COMMAND ${scene} -q EXIT 0
      MATCHES "ended by fraction" FILES concrete.hdf concrete.json concrete.log)
    continue()
  endif()
  if(name MATCHES "^(million|ten_million)$")
    set(smaller --set container.size=[0.5,0.5,0.48] --set dynamics.relaxation=0.005)
  elseif(name STREQUAL "cube_million")
    set(smaller --set container.size=[0.5,0.5,3.84] --set dynamics.relaxation=0.005)
  elseif(name STREQUAL "tall")
    set(smaller --set dynamics.relaxation=0.005)
  endif()
  if(name MATCHES "^(quickstart|graded_uniform|near_field|periodic_2d)$")
    set(labels sanitize)
  endif()
  packmpi_system_test(scene_${name} RANKS 2 LABELS ${labels}
    COMMAND ${scene} -q ${short} ${smaller} EXIT 3
    MATCHES "ended by layers.maximum" FILES ${name}.hdf ${name}.json ${name}.log ${name}.steps.csv)
endforeach()
add_test(NAME system/exit_codes.np2 COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/exit_codes.sh ${input}
  ${CMAKE_CURRENT_BINARY_DIR}/exit_codes.np2
  ${MPIEXEC_EXECUTABLE} ${MPIEXEC_NUMPROC_FLAG} 2 $<TARGET_FILE:packmpi_program>)
set_tests_properties(system/exit_codes.np2 PROPERTIES PROCESSORS 2 TIMEOUT 180
  ENVIRONMENT "${PACKMPI_MPI_ENVIRONMENT}" LABELS "system;np2")
if(PACKMPI_SYSTEM_PYTHON AND NOT PACKMPI_SANITIZE)   # the short version of scripts/dev/faults.py
  add_test(NAME system/faults COMMAND ${PACKMPI_SYSTEM_PYTHON} ${PROJECT_SOURCE_DIR}/scripts/dev/faults.py -n 1
    --build ${PROJECT_BINARY_DIR})
  set_tests_properties(system/faults PROPERTIES PROCESSORS 2 TIMEOUT 240 SKIP_RETURN_CODE 77
    ENVIRONMENT "${PACKMPI_MPI_ENVIRONMENT}" LABELS system)
endif()
