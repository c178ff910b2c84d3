# Warnings as errors for our own code. PRIVATE on every target of ours: who embeds a library of
# ours gets its flags of meaning (see solver/CMakeLists.txt), not our taste.
add_library(cycloid_warnings INTERFACE)
target_compile_options(cycloid_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror
  # Clang counts sign conversions among -Wconversion, GCC does not; the same set for both.
  -Wno-sign-conversion
  # GCC 12 warns of "text" + std::to_string(n) inside its own library (GCC bug 105329).
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>)
