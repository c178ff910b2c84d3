# As wasi.cmake, with WebAssembly's vectors of 128 bits.
set(CYCLOID_WASM_FEATURES -msimd128)
include(${CMAKE_CURRENT_LIST_DIR}/wasi.cmake)
