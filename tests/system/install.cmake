# Installs BUILD into FOLDER, moves the tree, and builds and runs CONSUMER against it.
cmake_minimum_required(VERSION 3.25)
function(run)
  execute_process(COMMAND ${ARGN} WORKING_DIRECTORY ${FOLDER} RESULT_VARIABLE code OUTPUT_VARIABLE text ERROR_VARIABLE text)
  if(NOT code EQUAL 0)
    list(JOIN ARGN " " command)
    message("${text}")
    message(FATAL_ERROR "exit code ${code}: ${command}")
  endif()
  set(text "${text}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${FOLDER})
file(MAKE_DIRECTORY ${FOLDER})
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${FOLDER}/first)
file(RENAME ${FOLDER}/first ${FOLDER}/moved)   # nothing may remember where it was installed

set(hidden)
if(SHARED)
  foreach(package PkgConfig HDF5 Eigen3 tomlplusplus CLI11 fmt spdlog nlohmann_json)
    list(APPEND hidden -DCMAKE_DISABLE_FIND_PACKAGE_${package}=ON)
  endforeach()
endif()
run(${CMAKE_COMMAND} -S ${CONSUMER} -B consumer -G ${GENERATOR} -DCMAKE_PREFIX_PATH=${FOLDER}/moved
  -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_FIND_USE_PACKAGE_REGISTRY=OFF ${hidden})
run(${CMAKE_COMMAND} --build consumer)
run(consumer/consumer ${SCENE})
if(NOT text MATCHES "packmpi ${VERSION} \\(.+, .+\\)\npack/quickstart.hdf: [1-9][0-9]* particles, code 3\nwithout a scene: code 2, .*no-such-scene")
  message(FATAL_ERROR "the consumer said: ${text}")
endif()

run(${FOLDER}/moved/bin/packmpi --version)
if(NOT text MATCHES "${VERSION}")
  message(FATAL_ERROR "packmpi --version said: ${text}")
endif()

# The tools in Python came along, and are found by the moved program; so are examples and documentation.
run(${FOLDER}/moved/bin/packmpi report --help)
if(NOT text MATCHES "usage: packmpi report")
  message(FATAL_ERROR "packmpi report --help said: ${text}")
endif()
foreach(page README.md tutorial.md input/quickstart.toml)
  if(NOT EXISTS ${FOLDER}/moved/share/doc/packmpi/${page})
    message(FATAL_ERROR "${page} was not installed")
  endif()
endforeach()

foreach(page man/man1/packmpi.1 bash-completion/completions/packmpi zsh/site-functions/_packmpi
        fish/vendor_completions.d/packmpi.fish)
  file(READ ${FOLDER}/moved/share/${page} text)
  if(NOT text MATCHES "max.*hours")
    message(FATAL_ERROR "${page} does not name the options")
  endif()
endforeach()
