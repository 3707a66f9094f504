// The number of made-up inputs that a test tries.
#pragma once

namespace rubric {

#if defined(__SANITIZE_ADDRESS__)
inline constexpr bool kSanitized = true;
#elif defined(__has_feature)
inline constexpr bool kSanitized = __has_feature(address_sanitizer);
#else
inline constexpr bool kSanitized = false;
#endif

/// Returns `count`, but a fifth of it under sanitizers: there each input takes ten times as long,
/// and the optimised build of the same test tries all of them, as fuzz/smoke tries more of a fuzz
/// target.
constexpr int made_inputs(int count) { return kSanitized ? count / 5 : count; }

}  // namespace rubric
