set(CMAKE_SYSTEM_PROCESSOR s390x)
set(CYCLOID_TRIPLE s390x-linux-gnu)
include(${CMAKE_CURRENT_LIST_DIR}/linux.cmake)
