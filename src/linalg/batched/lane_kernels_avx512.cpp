// Kernels for processors with AVX-512: 8 samples at a time. Compiled with those flags, see lane_flags.cmake.
#if defined(__x86_64__)
#define MOTTLE_LANES 8
#define MOTTLE_UPDATE_COLUMNS 3
#define MOTTLE_PRODUCT_COLUMNS 4
#define MOTTLE_VECTOR_GROUP 5
#define MOTTLE_TILE_ROWS 4
#include "linalg/batched/lanes/gathered_product.hpp"
#include "linalg/batched/lanes/nearby.hpp"
#include "linalg/batched/lanes/solve.hpp"
#include "linalg/batched/lanes/sparse_product.hpp"
#include "linalg/batched/lanes/supernodal_solve.hpp"

namespace mottle::linalg::lane_kernels {
const Kernels k_avx512{jacobi_avx512,        solve_large,           workspace_doubles,      solve_nearby,
                       nearby_doubles,       add_symmetric_product, add_local_product,      add_scaled_product,
                       add_gathered_product, solve_lower,           solve_lower_transposed, MOTTLE_LANES};
}
#endif
