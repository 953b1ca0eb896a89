// Keeps BLAS from starting threads that it could not feed.
#pragma once

#include "mottle/layers.hpp"

namespace mottle::app {

/// OpenBLAS starts its threads before main. Mottle does not use them, and where the address space is limited they wait
/// for memory for ever: there, the program starts again without them. Returns only where nothing is to be done.
void leave_out_blas_threads(char** arguments);

}  // namespace mottle::app
