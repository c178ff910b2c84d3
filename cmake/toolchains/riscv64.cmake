set(CMAKE_SYSTEM_PROCESSOR riscv64)
set(CYCLOID_TRIPLE riscv64-linux-gnu)
include(${CMAKE_CURRENT_LIST_DIR}/linux.cmake)
