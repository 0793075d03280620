# Installs the project into a folder of the build, then builds and runs a small program outside of it that finds the package.
#   cmake -DBUILD=<build folder> -DSOURCE=<of the program> -DGENERATOR= -DCXX= -DCXX_FLAGS= -DTYPE= -P run.cmake
set(work "${BUILD}/package_test")
set(prefix "${work}/prefix")
file(REMOVE_RECURSE "${work}")

function(run)
    execute_process(COMMAND ${ARGV} RESULT_VARIABLE code OUTPUT_VARIABLE output ERROR_VARIABLE output)
    message("${output}")
    if(NOT code EQUAL 0)
        string(REPLACE ";" " " command "${ARGV}")
        message(FATAL_ERROR "exit code ${code}: ${command}")
    endif()
endfunction()

run("${CMAKE_COMMAND}" --install "${BUILD}" --prefix "${prefix}")
run("${CMAKE_COMMAND}" -S "${SOURCE}" -B "${work}/build" -G "${GENERATOR}" "-DCMAKE_PREFIX_PATH=${prefix}"
    "-DCMAKE_CXX_COMPILER=${CXX}" "-DCMAKE_CXX_FLAGS=${CXX_FLAGS}" "-DCMAKE_BUILD_TYPE=${TYPE}")
run("${CMAKE_COMMAND}" --build "${work}/build")
# From a folder without the sources, with the content that was installed.
run("${CMAKE_COMMAND}" -E chdir "${work}" "${work}/build/outside" "${prefix}/share/zoetrope/content/default.glb")
# The tree of the headers must not depend on the project's own folder.
file(GLOB_RECURSE configs "${prefix}/*.cmake")
foreach(config IN LISTS configs)
    file(READ "${config}" text)
    string(FIND "${text}" "${BUILD}/" place)
    if(NOT place EQUAL -1 AND NOT config MATCHES "package_test/build")
        string(FIND "${text}" "${prefix}" own)
        if(own EQUAL -1)
            message(FATAL_ERROR "${config} names the build folder")
        endif()
    endif()
endforeach()
