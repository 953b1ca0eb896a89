# Installs the command and, as a CMake package, the library: find_package(mottle), target mottle::mottle (everything)
# or mottle::<layer>. cpack makes Debian packages of it: mottle (the command), libmottle-dev and, where MPI
# was found, mottle-mpi; where the Python package is built, python3-mottle.
option(MOTTLE_INSTALL "Make install and package rules" ${PROJECT_IS_TOP_LEVEL})
if(NOT MOTTLE_INSTALL OR MOTTLE_OPTIMISED_BUILD)
  return()
endif()
include(CMakePackageConfigHelpers)
include(PublicHeaders)

set(mottle_cmake_dir ${CMAKE_INSTALL_LIBDIR}/cmake/mottle)
get_property(mottle_layers GLOBAL PROPERTY MOTTLE_LAYERS)
add_library(mottle INTERFACE)
add_library(mottle::mottle ALIAS mottle)
target_link_libraries(mottle INTERFACE mottle::report)  # the top layer; the others follow from it

# mottle_tomlplusplus, mottle_re2, mottle_sparse and mottle_hdf5 are exported
# because a static library names even what it links privately.
install(TARGETS ${mottle_layers} mottle_tomlplusplus mottle_re2 mottle_sparse mottle_hdf5 mottle EXPORT mottle
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
mottle_public_headers(mottle_headers)
foreach(header ${mottle_headers})
  cmake_path(GET header PARENT_PATH folder)
  install(FILES include/${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/${folder} COMPONENT development)
endforeach()
install(EXPORT mottle FILE mottleTargets.cmake NAMESPACE mottle:: DESTINATION ${mottle_cmake_dir}
  COMPONENT development)
configure_package_config_file(cmake/mottleConfig.cmake.in mottleConfig.cmake INSTALL_DESTINATION ${mottle_cmake_dir})
# Until 1.0 a minor version may break what uses it.
write_basic_package_version_file(mottleConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/mottleConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/mottleConfigVersion.cmake
  DESTINATION ${mottle_cmake_dir} COMPONENT development)

install(TARGETS mottle_app RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT runtime)
set_target_properties(mottle_app PROPERTIES INSTALL_RPATH "$ORIGIN/../${CMAKE_INSTALL_LIBDIR}/mottle")
install(TARGETS mottle_openturns LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/mottle COMPONENT runtime)
if(MOTTLE_MPI)
  install(TARGETS mottle_mpi LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/mottle COMPONENT mpi)
  install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/mottle-mpi RENAME copyright COMPONENT mpi)
endif()
if(MOTTLE_BUILD_PYTHON)
  set(mottle_site lib/python3/dist-packages)  # Debian's place for every Python 3
  # The package has a module for OpenTURNS of its own: it does not need the command.
  install(TARGETS mottle_python mottle_openturns LIBRARY DESTINATION ${mottle_site}/mottle COMPONENT python)
  install(DIRECTORY bindings/python/mottle DESTINATION ${mottle_site} COMPONENT python
    FILES_MATCHING PATTERN "*.py" PATTERN "*.pyi" PATTERN "py.typed")
  install(FILES ${PROJECT_BINARY_DIR}/python/mottle/options.py DESTINATION ${mottle_site}/mottle COMPONENT python)
  # What pip and importlib.metadata read.
  file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/METADATA
    "Metadata-Version: 2.1\nName: mottle\nVersion: ${PROJECT_VERSION}\nSummary: ${PROJECT_DESCRIPTION}\n"
    "License: BSD-3-Clause\nRequires-Python: >=3.9\nRequires-Dist: numpy\n")
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/METADATA DESTINATION ${mottle_site}/mottle-${PROJECT_VERSION}.dist-info
    COMPONENT python)
  install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/python3-mottle RENAME copyright COMPONENT python)
endif()
find_program(MOTTLE_HELP2MAN help2man)  # without it there are no man pages
if(MOTTLE_HELP2MAN)
  set(mottle_man ${CMAKE_CURRENT_BINARY_DIR}/man)
  add_custom_command(OUTPUT ${mottle_man}/mottle.1.gz
    COMMAND ${PROJECT_SOURCE_DIR}/tools/make_man_pages.sh $<TARGET_FILE:mottle_app> ${mottle_man}
    DEPENDS mottle_app tools/make_man_pages.sh VERBATIM)
  add_custom_target(mottle_man_pages ALL DEPENDS ${mottle_man}/mottle.1.gz)
  install(DIRECTORY ${mottle_man}/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT runtime)
endif()
set(mottle_completion ${CMAKE_CURRENT_BINARY_DIR}/completion)
file(MAKE_DIRECTORY ${mottle_completion})
foreach(shell_file bash:mottle zsh:_mottle fish:mottle.fish)
  string(REPLACE ":" ";" pair ${shell_file})
  list(GET pair 0 shell)
  list(GET pair 1 name)
  add_custom_command(OUTPUT ${mottle_completion}/${name}
    COMMAND $<TARGET_FILE:mottle_app> completion ${shell} > ${mottle_completion}/${name} DEPENDS mottle_app VERBATIM)
  list(APPEND mottle_completion_files ${mottle_completion}/${name})
endforeach()
add_custom_target(mottle_completions ALL DEPENDS ${mottle_completion_files})
install(FILES ${mottle_completion}/mottle DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
  COMPONENT runtime)
install(FILES ${mottle_completion}/_mottle DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions COMPONENT runtime)
install(FILES ${mottle_completion}/mottle.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d
  COMPONENT runtime)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/mottle RENAME copyright COMPONENT runtime)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/libmottle-dev RENAME copyright COMPONENT development)
install(DIRECTORY examples DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/mottle COMPONENT runtime
  PATTERN "*.mottle" EXCLUDE PATTERN "__pycache__" EXCLUDE PATTERN "06-cpp-library" EXCLUDE)
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/mottle COMPONENT runtime)
install(FILES README.md CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/mottle COMPONENT runtime)
install(DIRECTORY examples/06-cpp-library DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/libmottle-dev/examples
  COMPONENT development)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME mottle)
set(CPACK_PACKAGE_CONTACT "Mottle developers")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "stochastic finite-element model updating")
set(CPACK_STRIP_FILES ON)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL runtime development)
if(MOTTLE_MPI)
  list(APPEND CPACK_COMPONENTS_ALL mpi)
endif()
if(MOTTLE_BUILD_PYTHON)
  list(APPEND CPACK_COMPONENTS_ALL python)
  find_package(Python3 REQUIRED COMPONENTS Interpreter)
  math(EXPR mottle_next_python "${Python3_VERSION_MINOR} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-mottle)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS  # the module is made for one minor version
    "python3 (>= 3.${Python3_VERSION_MINOR}), python3 (<< 3.${mottle_next_python}), python3-numpy")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS
    "libopenblas0, python3-matplotlib, python3-pandas, python3-scipy, python3-tqdm, python3-xarray")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "mottle, jupyter-notebook")  # mottle has the notebooks, with their data
  set(CPACK_COMPONENT_PYTHON_DESCRIPTION
"Mottle's engine as a Python module: studies, a Python function as the model,
results as NumPy arrays, and the routines that stand alone.")
endif()
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_NAME mottle)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SECTION science)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_RECOMMENDS "libopenblas0")  # the reference BLAS takes twice as long
set(CPACK_COMPONENT_RUNTIME_DESCRIPTION
"From modal tests of many nominally identical structures and a finite-element
model with uncertain parameters, Mottle finds the distribution of the
parameters that explains the measured scatter, and says how sure that is.")
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SUGGESTS "mottle-mpi")
set(CPACK_DEBIAN_MPI_PACKAGE_NAME mottle-mpi)
set(CPACK_DEBIAN_MPI_PACKAGE_SECTION science)
set(CPACK_DEBIAN_MPI_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_MPI_PACKAGE_DEPENDS "mottle (= ${PROJECT_VERSION}), openmpi-bin")
set(CPACK_COMPONENT_MPI_DESCRIPTION
"The module by which mpirun and srun run Mottle as many processes that share
the model's evaluations.")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libmottle-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS  # mottle has the modules that are loaded on demand
  "mottle (= ${PROJECT_VERSION}), libboost-dev, libeigen3-dev, libfmt-dev, libhdf5-dev, libmumps-seq-dev, libblas-dev, libre2-dev, libsuitesparse-dev, libtomlplusplus-dev, nlohmann-json3-dev, zlib1g-dev")
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION
"Headers, static libraries and CMake package of Mottle, an engine for
stochastic finite-element model updating.")
include(CPack)
