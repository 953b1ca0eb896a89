# The same kernel source is compiled once per register width; the width is chosen at run time (batch_eigen.cpp).
# Optimised in debug builds too: without inlining every vector operation is a call. The Jacobi files, unrolled
# arithmetic in registers, would take sanitizers ten minutes to compile; the kernels that work in memory keep them.
# Clang fuses a product and a sum here and not there, so that a sample's bits would depend on its place in a batch.
set(simd_flags -O3 -ffp-contract=$<IF:$<CXX_COMPILER_ID:GNU>,fast,off> -fno-math-errno -fno-trapping-math)
set(simd_flags_avx2 -mavx2 -mfma)
set(simd_flags_avx512 ${simd_flags_avx2} -mavx512f -mavx512dq -mavx512vl -mprefer-vector-width=512)
foreach(level plain avx2 avx512)
  set(level_flags ${simd_flags})
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
    list(APPEND level_flags ${simd_flags_${level}})
  endif()
  set_source_files_properties(src/linalg/batched/simd_kernels_${level}.cpp PROPERTIES COMPILE_OPTIONS "${level_flags}")
  set_source_files_properties(src/linalg/batched/simd_jacobi_${level}.cpp PROPERTIES
    COMPILE_OPTIONS "${level_flags};-fno-sanitize=all")
  set_source_files_properties(src/linalg/batched/simd_kernels_${level}.cpp src/linalg/batched/simd_jacobi_${level}.cpp PROPERTIES
    SKIP_PRECOMPILE_HEADERS ON)  # which are made with other flags
endforeach()
