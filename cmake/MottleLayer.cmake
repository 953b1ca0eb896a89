include(MottleUnity)

# mottle_layer(NAME [USES layer...] [LINKS PUBLIC|PRIVATE target...] [OPTIMISE -O1|-O2])
# Makes the static library mottle_NAME (alias mottle::NAME) from the sources in src/NAME and its rooms, with include/mottle/NAME.
# OPTIMISE is the level of the release build; without it, -O3.
function(mottle_layer name)
  cmake_parse_arguments(LAYER "" "OPTIMISE" "USES;LINKS" ${ARGN})
  set_property(GLOBAL APPEND PROPERTY MOTTLE_LAYERS mottle_${name})
  if(MOTTLE_OPTIMISED_BUILD AND NOT name IN_LIST MOTTLE_SANITIZED_LAYERS)
    mottle_optimised_layer(${name})
    return()
  endif()
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/${name}/*.cpp)
  add_library(mottle_${name} STATIC ${sources})
  add_library(mottle::${name} ALIAS mottle_${name})
  set_target_properties(mottle_${name} PROPERTIES EXPORT_NAME ${name} LINKER_LANGUAGE CXX)
  target_compile_features(mottle_${name} PUBLIC cxx_std_20)
  target_include_directories(mottle_${name}
    PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>
    PRIVATE ${PROJECT_SOURCE_DIR}/src)
  mottle_warnings(mottle_${name})
  if(LAYER_OPTIMISE)
    mottle_optimise(mottle_${name} ${LAYER_OPTIMISE})
  endif()
  mottle_precompile(mottle_${name} <Eigen/Dense> <fmt/format.h> <filesystem> <functional> <map> <string> <vector>)
  mottle_unity(mottle_${name})
  foreach(lower ${LAYER_USES})
    target_link_libraries(mottle_${name} PUBLIC mottle::${lower})
  endforeach()
  if(LAYER_LINKS)
    target_link_libraries(mottle_${name} ${LAYER_LINKS})
  endif()
endfunction()

# The layer as the optimised build has it; what it links is known from the arguments of mottle_layer, which called this.
macro(mottle_optimised_layer name)
  add_library(mottle_${name} STATIC IMPORTED GLOBAL)
  add_library(mottle::${name} ALIAS mottle_${name})
  set_target_properties(mottle_${name} PROPERTIES IMPORTED_LOCATION ${MOTTLE_OPTIMISED_BUILD}/libmottle_${name}.a)
  target_compile_features(mottle_${name} INTERFACE cxx_std_20)
  target_include_directories(mottle_${name} INTERFACE ${PROJECT_SOURCE_DIR}/include)
  list(REMOVE_ITEM LAYER_LINKS PUBLIC PRIVATE)
  list(TRANSFORM LAYER_USES PREPEND mottle::)
  target_link_libraries(mottle_${name} INTERFACE ${LAYER_USES} ${LAYER_LINKS})
endmacro()

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

# mottle_optimise(TARGET LEVEL): the level of the release build where -O3 costs time to compile and saves none to run. No
# level changes a result: none lets the compiler reorder operations or fuse them.
function(mottle_optimise target level)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:${level}>)
endfunction()

# mottle_precompile(TARGET header...): reads these once for the target, if MOTTLE_PRECOMPILE. The presets dev and plain go without,
# so that a source that includes too little does not compile.
function(mottle_precompile target)
  if(MOTTLE_PRECOMPILE AND NOT target MATCHES "^mottle_core")  # core goes without Eigen
    target_precompile_headers(${target} PRIVATE ${ARGN})
    if(CMAKE_CXX_COMPILER_LAUNCHER MATCHES "ccache" AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
      target_compile_options(${target} PRIVATE -fpch-preprocess)  # else ccache keeps nothing of it
    endif()
  endif()
endfunction()
