# Writes OUTPUT with what this build is made of. The file's time changes only where its text does, so that an unchanged
# commit builds nothing anew.
execute_process(COMMAND git -C ${SOURCE} describe --always --dirty --abbrev=12 OUTPUT_VARIABLE commit ERROR_QUIET
    OUTPUT_STRIP_TRAILING_WHITESPACE RESULT_VARIABLE failed)
if(failed)
    set(commit unknown)
endif()
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT [[#pragma once

#define ZOETROPE_VERSION "@VERSION@"
#define ZOETROPE_COMMIT "@commit@"
#define ZOETROPE_COMPILER "@COMPILER@"
#define ZOETROPE_FLAGS "@FLAGS@"
]] @ONLY)
