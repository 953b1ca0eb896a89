// Whether this program is slow on purpose.
#pragma once

namespace mottle::test {

/// Under sanitizers arithmetic takes ten to a hundred times as long: statistical claims and large samples are left to
/// the optimised build, what they run is run by other tests.
#if defined(__has_feature)  // clang's
inline constexpr bool k_is_instrumented = __has_feature(address_sanitizer) || __has_feature(thread_sanitizer);
#elif defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool k_is_instrumented = true;
#else
inline constexpr bool k_is_instrumented = false;
#endif

inline constexpr const char* k_left_to_optimised_build = "replications or many large samples: make test runs them";

}  // namespace mottle::test
