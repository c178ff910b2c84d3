# cmake -DBUILD=... -P: installs BUILD into a prefix under WORK, then configures, builds and runs
# CONSUMER against that prefix alone. FLAGS are those of BUILD: a sanitizer has to be in both.
set(prefix ${WORK}/prefix)
file(REMOVE_RECURSE ${WORK})

function(run)
  execute_process(COMMAND ${ARGV} COMMAND_ECHO STDOUT COMMAND_ERROR_IS_FATAL ANY)
endfunction()

run(${CMAKE_COMMAND} --install ${BUILD} --config "${CONFIG}" --prefix ${prefix})
run(${CMAKE_COMMAND} -S ${CONSUMER} -B ${WORK}/build -G ${GENERATOR}
  -DCMAKE_PREFIX_PATH=${prefix} -DCMAKE_BUILD_TYPE=${CONFIG}
  -DCMAKE_CXX_COMPILER=${COMPILER} "-DCMAKE_CXX_FLAGS=${FLAGS}" -DEigen3_DIR=${EIGEN})
run(${CMAKE_COMMAND} --build ${WORK}/build)
run(${WORK}/build/consumer)
