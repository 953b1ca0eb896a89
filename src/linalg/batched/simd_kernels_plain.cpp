// Kernels for every processor: 2 samples at a time.
#define MOTTLE_LANES 2
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
const Kernels k_plain{jacobi_plain,         solve_large,           workspace_doubles,      solve_davidson,
                      davidson_doubles,     add_symmetric_product, add_local_product,      add_scaled_product,
                      add_gathered_product, solve_lower,           solve_lower_transposed, MOTTLE_LANES};
}
