// A library like many: linked with -ffast-math, which puts code into it that flushes subnormal
// numbers as soon as it is loaded. Clang 19 no longer does so; its libraries do it by themselves.

#ifdef FLUSHES_BY_ITSELF
#include <immintrin.h>
#endif

namespace {

#ifdef FLUSHES_BY_ITSELF
[[gnu::constructor]] void flush_subnormals() {
  _mm_setcsr(_mm_getcsr() | 0x8040u);
}
#endif

}  // namespace

extern "C" float cycloid_flushing_half(float x) {
  return x * 0.5f;
}
