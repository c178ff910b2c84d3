set(CMAKE_SYSTEM_PROCESSOR ppc64le)
set(CYCLOID_TRIPLE powerpc64le-linux-gnu)
include(${CMAKE_CURRENT_LIST_DIR}/linux.cmake)
