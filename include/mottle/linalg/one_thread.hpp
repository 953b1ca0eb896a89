// Switches off the threads that other packages (BLAS, OpenMP) would start.
#pragma once

namespace mottle::linalg {

/// Keeps BLAS, and the OpenMP loops of the sparse packages, from starting threads of their own inside the calling
/// thread: they would slow both down and change the last bits of sums. To be called wherever such a package is entered.
void use_one_thread();

}  // namespace mottle::linalg
