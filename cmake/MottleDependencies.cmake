# Every outside library that Mottle links, all of them Debian packages (tools/install_packages.sh).
find_package(Threads REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(fmt 9 REQUIRED)
find_package(Boost 1.74 REQUIRED)
find_package(ZLIB REQUIRED)
find_package(OpenTURNS 1.20 REQUIRED)  # by its module alone (modules/openturns)
find_package(nlohmann_json 3.11 REQUIRED)
find_package(CLI11 2.1 REQUIRED)
find_package(tomlplusplus 3.3 REQUIRED)
find_path(RANDOM123_INCLUDE_DIR Random123/philox.h REQUIRED)
find_path(XXHASH_INCLUDE_DIR xxhash.h REQUIRED)

# Sparse factorisations; BLAS comes with them and is called directly for the products between.
set(BLA_VENDOR Generic)  # the system's alternative, which the other libraries link too
find_package(BLAS REQUIRED)
find_path(CHOLMOD_INCLUDE_DIR suitesparse/cholmod.h REQUIRED)
find_library(CHOLMOD_LIBRARY cholmod REQUIRED)
find_path(MUMPS_INCLUDE_DIR dmumps_c.h REQUIRED)
find_library(MUMPS_LIBRARY dmumps_seq REQUIRED)
if(NOT TARGET mottle_sparse)
  add_library(mottle_sparse INTERFACE)
  target_include_directories(mottle_sparse SYSTEM INTERFACE ${CHOLMOD_INCLUDE_DIR} ${MUMPS_INCLUDE_DIR})
  target_link_libraries(mottle_sparse INTERFACE ${CHOLMOD_LIBRARY} ${MUMPS_LIBRARY} BLAS::BLAS)
endif()

find_path(RE2_INCLUDE_DIR re2/re2.h REQUIRED)
find_library(RE2_LIBRARY re2 REQUIRED)
if(NOT TARGET mottle_re2)
  add_library(mottle_re2 INTERFACE)
  target_include_directories(mottle_re2 SYSTEM INTERFACE ${RE2_INCLUDE_DIR})
  target_link_libraries(mottle_re2 INTERFACE ${RE2_LIBRARY})
endif()

# The C library alone; Debian keeps its serial build beside the parallel ones.
find_path(HDF5_INCLUDE_DIR hdf5.h PATH_SUFFIXES hdf5/serial REQUIRED)
find_library(HDF5_LIBRARY NAMES hdf5_serial hdf5 REQUIRED)
if(NOT TARGET mottle_hdf5)
  add_library(mottle_hdf5 INTERFACE)
  target_include_directories(mottle_hdf5 SYSTEM INTERFACE ${HDF5_INCLUDE_DIR})
  target_link_libraries(mottle_hdf5 INTERFACE ${HDF5_LIBRARY})
endif()

if(NOT TARGET mottle_tomlplusplus)
  # TOML_HEADER_ONLY would compile the parser into every file; one translation unit holds it instead.
  add_library(mottle_tomlplusplus INTERFACE)
  target_link_libraries(mottle_tomlplusplus INTERFACE tomlplusplus::tomlplusplus)
endif()

# Modules that are loaded on demand are found along the run path, which an installation takes off again.
list(APPEND CMAKE_BUILD_RPATH ${PROJECT_BINARY_DIR})
