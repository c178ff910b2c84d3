# WebAssembly with the system interface WASI, by Clang 19 and its libc++. No threads there, and no
# exceptions: a throw ends the program (see docs/determinism.md and cli/uncatchable.cpp).
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR wasm32)
set(CMAKE_CXX_COMPILER clang++-19)
set(CMAKE_CXX_COMPILER_TARGET wasm32-wasi)
set(CMAKE_EXECUTABLE_SUFFIX_CXX .wasm)
# -fignore-exceptions: try and throw compile, but nothing is caught.
set(CMAKE_CXX_FLAGS_INIT
  "-fignore-exceptions -isystem ${CMAKE_CURRENT_LIST_DIR}/wasi ${CYCLOID_WASM_FEATURES}")
# The linker's own 64 KiB of stack are too few for a step.
set(CMAKE_EXE_LINKER_FLAGS_INIT "-Wl,-z,stack-size=8388608")
# CLI11 reads numbers as long double, which wasi's C library leaves out of its scanf unless asked.
set(CMAKE_CXX_STANDARD_LIBRARIES_INIT -lc-printscan-long-double)
