// Whether this program is slow on purpose.
#pragma once

namespace mottle::test {

/// Under sanitizers replications take ten times as long and reach no line that other tests do not: they are left to the
/// optimised build.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool k_is_instrumented = true;
#else
inline constexpr bool k_is_instrumented = false;
#endif

}  // namespace mottle::test
