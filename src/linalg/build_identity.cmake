# build_identity.hpp, made anew when a source of the numerical core changes.
file(GLOB_RECURSE identity_sources CONFIGURE_DEPENDS src/core/* src/linalg/* include/mottle/core/* include/mottle/linalg/*)
string(TOUPPER "${CMAKE_BUILD_TYPE}" build_type)
set(identity_header ${CMAKE_CURRENT_BINARY_DIR}/identity/build_identity.hpp)
add_custom_command(OUTPUT ${identity_header}
  COMMAND ${CMAKE_COMMAND} -D OUTPUT=${identity_header} -D ROOT=${PROJECT_SOURCE_DIR}
    "-DBUILD=${PROJECT_VERSION} ${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION} ${CMAKE_SYSTEM_PROCESSOR} ${CMAKE_CXX_FLAGS} ${CMAKE_CXX_FLAGS_${build_type}}"
    -P ${PROJECT_SOURCE_DIR}/cmake/BuildIdentity.cmake
  DEPENDS ${identity_sources} ${PROJECT_SOURCE_DIR}/cmake/BuildIdentity.cmake VERBATIM)
add_custom_target(mottle_build_identity DEPENDS ${identity_header})
add_dependencies(mottle_linalg mottle_build_identity)
target_sources(mottle_linalg PRIVATE ${identity_header})
target_include_directories(mottle_linalg PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/identity)
