// Whether this program is slow on purpose.
#pragma once

namespace mottle::test {

using namespace model;  // of which these are the tests

/// Under sanitizers replications take ten times as long: statistical claims are left to the optimised build, what they
/// run is run by other tests.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool k_is_instrumented = true;
#else
inline constexpr bool k_is_instrumented = false;
#endif

inline constexpr const char* k_left_to_optimised_build = "replications: make test runs them";

}  // namespace mottle::test
