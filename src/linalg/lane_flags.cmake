# The same kernel source is compiled once per register width; the width is chosen at run time (batch_eigen.cpp).
# Optimised in debug builds too: without inlining every vector operation is a call.
set(lane_flags -O3 -ffp-contract=fast -fno-math-errno -fno-trapping-math)
set_source_files_properties(src/linalg/lane_kernels_plain.cpp PROPERTIES COMPILE_OPTIONS "${lane_flags}")
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  set_source_files_properties(src/linalg/lane_kernels_avx2.cpp PROPERTIES COMPILE_OPTIONS "${lane_flags};-mavx2;-mfma")
  set_source_files_properties(src/linalg/lane_kernels_avx512.cpp PROPERTIES COMPILE_OPTIONS
    "${lane_flags};-mavx2;-mfma;-mavx512f;-mavx512dq;-mavx512vl;-mprefer-vector-width=512")
endif()
