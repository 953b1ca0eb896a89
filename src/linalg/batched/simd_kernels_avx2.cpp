// Kernels for processors with AVX2 and FMA: 4 samples at a time. Compiled with those flags, see simd_flags.cmake.
#if defined(__x86_64__)
#define MOTTLE_LANES 4
#define MOTTLE_UPDATE_COLUMNS 2
#define MOTTLE_PRODUCT_COLUMNS 4
#define MOTTLE_VECTOR_GROUP 3
#define MOTTLE_TILE_ROWS 2
#include "linalg/batched/simd/accurate_product.hpp"
#include "linalg/batched/simd/davidson.hpp"
#include "linalg/batched/simd/gathered_product.hpp"
#include "linalg/batched/simd/solve.hpp"
#include "linalg/batched/simd/supernodal_solve.hpp"

namespace mottle::linalg::simd_kernels {
const Kernels k_avx2{jacobi_avx2,          solve_large,           workspace_doubles,      solve_davidson,
                     davidson_doubles,     add_symmetric_product, add_local_product,      add_scaled_product,
                     add_gathered_product, solve_lower,           solve_lower_transposed, MOTTLE_LANES};
}
#endif
