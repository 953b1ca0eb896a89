# cmake -D OUTPUT=... -D ROOT=... -D BUILD=... -P BuildIdentity.cmake
# Fills in src/linalg/build_identity.hpp.in.
cmake_minimum_required(VERSION 3.25)
file(GLOB_RECURSE sources RELATIVE ${ROOT} ${ROOT}/src/core/* ${ROOT}/src/linalg/* ${ROOT}/include/mottle/core/*
  ${ROOT}/include/mottle/linalg/*)
list(SORT sources)
set(digests "")
foreach(source IN LISTS sources)
  file(SHA256 ${ROOT}/${source} digest)
  string(APPEND digests "${source} ${digest}\n")
endforeach()
string(SHA256 digest "${digests}")
configure_file(${ROOT}/src/linalg/build_identity.hpp.in ${OUTPUT} @ONLY)
file(TOUCH ${OUTPUT})
