# cmake -DFROM=... -DTO=... -DTEXT=... -DWRONG=... -P overlay.cmake: copies a source file with one
# text replaced. The text stands in the source exactly once, or the build fails: a wrong rounding
# that is not there would be found by nobody.
file(READ "${FROM}" source)
file(READ "${TEXT}" text)
file(READ "${WRONG}" wrong)
string(FIND "${source}" "${text}" first)
string(FIND "${source}" "${text}" last REVERSE)
if(first EQUAL -1 OR NOT first EQUAL last)
  message(FATAL_ERROR "${FROM} does not hold the text of ${TEXT} exactly once; "
    "change that file with the source")
endif()
string(REPLACE "${text}" "${wrong}" source "${source}")
file(WRITE "${TO}" "${source}")
