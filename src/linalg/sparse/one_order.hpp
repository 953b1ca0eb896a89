// Orders of elimination, which CHOLMOD and MUMPS have METIS find.
#pragma once

#include "mottle/core/process_mutex.hpp"

namespace mottle::linalg {

/// Held while METIS may run: it draws from rand(), which all threads share, and orders that are found at once would
/// differ from run to run.
ProcessMutex& one_order_at_a_time();

}  // namespace mottle::linalg
