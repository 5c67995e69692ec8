# Installs the build into a fresh prefix, then configures, builds and runs the consumer against it.
#   cmake -DBUILD=<build dir> -DSOURCE=<this folder> -DWORK=<scratch> -DGENERATOR=<name> -DCXX=<compiler> -P run.cmake
include(${CMAKE_CURRENT_LIST_DIR}/step.cmake)
file(REMOVE_RECURSE ${WORK})
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix)
run(${CMAKE_COMMAND} -S ${SOURCE} -B ${WORK}/build -G ${GENERATOR} -DCMAKE_PREFIX_PATH=${WORK}/prefix -DCMAKE_CXX_COMPILER=${CXX}
    "-DCMAKE_CXX_FLAGS=${FLAGS}")
run(${CMAKE_COMMAND} --build ${WORK}/build)
run(${WORK}/build/consumer)
run(${WORK}/build/memory)
run(${WORK}/build/robot ${WORK}/prefix/share/delassus/robots/go2.urdf ${WORK}/prefix/share/delassus/scenes/go2_standing.yaml)
# A program without flags, whatever the library was compiled with.
run(${CMAKE_COMMAND} -S ${SOURCE} -B ${WORK}/plain -G ${GENERATOR} -DCMAKE_PREFIX_PATH=${WORK}/prefix -DCMAKE_CXX_COMPILER=${CXX})
run(${CMAKE_COMMAND} --build ${WORK}/plain --target consumer memory)
run(${WORK}/plain/consumer)
run(${WORK}/plain/memory)
foreach(private models/formats/yaml.h models/shapes/mesh.h algorithms/factors/factor.h)
  if(EXISTS ${WORK}/prefix/include/delassus/${private})
    message(FATAL_ERROR "${private} is installed, and is no public header")
  endif()
endforeach()
