// Splits an index range over threads. Chunk borders depend on `grain` alone, never on the number of threads, so
// a body that treats chunks independently gives the same numbers at any thread count.
#pragma once

#include <cstdint>
#include <functional>

namespace mottle {

/// Calls body(begin, end) for consecutive chunks of [0, count) of `grain` indices (the last may be shorter).
///
/// @param count    >= 0
/// @param grain    chunk length, >= 1
/// @param threads  >= 1; the calling thread is one of them
/// @param body     must not touch what another chunk writes
/// Errors: the first exception thrown by a body is rethrown here once all threads have come to rest.
void parallel_for(std::int64_t count, std::int64_t grain, int threads,
                  const std::function<void(std::int64_t begin, std::int64_t end)>& body);

/// Number of processors this process may run on, at least 1.
int available_threads();

}  // namespace mottle
