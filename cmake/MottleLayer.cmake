include(MottleUnity)

# mottle_layer(NAME [USES layer...] [LINKS PUBLIC|PRIVATE target...])
# Makes the static library mottle_NAME (alias mottle::NAME) from the sources in src/NAME and its rooms, with include/mottle/NAME.
function(mottle_layer name)
  cmake_parse_arguments(LAYER "" "" "USES;LINKS" ${ARGN})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/${name}/*.cpp)
  add_library(mottle_${name} STATIC ${sources})
  add_library(mottle::${name} ALIAS mottle_${name})
  set_target_properties(mottle_${name} PROPERTIES EXPORT_NAME ${name} LINKER_LANGUAGE CXX)
  target_compile_features(mottle_${name} PUBLIC cxx_std_20)
  target_include_directories(mottle_${name}
    PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>
    PRIVATE ${PROJECT_SOURCE_DIR}/src)
  mottle_warnings(mottle_${name})
  mottle_precompile(mottle_${name} <Eigen/Dense> <fmt/format.h> <filesystem> <functional> <map> <string> <vector>)
  mottle_unity(mottle_${name})
  foreach(lower ${LAYER_USES})
    target_link_libraries(mottle_${name} PUBLIC mottle::${lower})
  endforeach()
  if(LAYER_LINKS)
    target_link_libraries(mottle_${name} ${LAYER_LINKS})
  endif()
  set_property(GLOBAL APPEND PROPERTY MOTTLE_LAYERS mottle_${name})
endfunction()

function(mottle_warnings target)
  if(CMAKE_CXX_FLAGS MATCHES "-fsanitize")
    return()  # the plain builds warn; sanitizers cost time enough, and make warnings that are false
  endif()
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
    -Wnon-virtual-dtor -Woverloaded-virtual -Wdouble-promotion)
  if(MOTTLE_WERROR)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
endfunction()

# mottle_precompile(TARGET header...): reads these once for the target, if MOTTLE_PRECOMPILE. The plain build goes without,
# so that a source that includes too little does not compile.
function(mottle_precompile target)
  if(MOTTLE_PRECOMPILE AND NOT target MATCHES "^mottle_core")  # core goes without Eigen
    target_precompile_headers(${target} PRIVATE ${ARGN})
    if(CMAKE_CXX_COMPILER_LAUNCHER MATCHES "ccache" AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
      target_compile_options(${target} PRIVATE -fpch-preprocess)  # else ccache keeps nothing of it
    endif()
  endif()
endfunction()
