# One place for language level, warnings, tuning and sanitizers. Every folder's target comes through grouser_library().
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_SKIP_RPATH ON)  # libraries are where the system looks for them, and nowhere else
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR})
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "" FORCE)
endif()

add_library(grouser_options INTERFACE)
target_compile_options(grouser_options INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Wcast-align -Wold-style-cast
  -Wnon-virtual-dtor -Woverloaded-virtual "$<$<CXX_COMPILER_ID:GNU>:-Wduplicated-cond;-Wlogical-op>" -Wnull-dereference
  -Wimplicit-fallthrough -Werror)
# Vectors wider than the machine's are passed between this program's own parts only: their calling convention, which GCC
# warns of, meets no other program.
target_compile_options(grouser_options INTERFACE -Wno-psabi)
# -O3 vectorises the structure-of-arrays loops. NaN and infinity keep their meaning: failures are detected by them.
target_compile_options(grouser_options INTERFACE
  $<$<CONFIG:Release>:-O3 -fno-math-errno -fno-trapping-math>)
if(GROUSER_NATIVE)
  # PUBLIC to every target alike: Eigen's alignment depends on it, so objects built differently must not meet.
  target_compile_options(grouser_options INTERFACE -march=native)
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  # GCC 12 calls the undefined halves of its own AVX-512 intrinsics uninitialized (GCC bug 105593) and sees overlaps in its own
  # std::string (bug 105651).
  target_compile_options(grouser_options INTERFACE -Wno-uninitialized -Wno-maybe-uninitialized -Wno-restrict)
endif()
# Hardening: what it must have done to the program is read from the built files by tests/reliability/binary.py.
target_compile_options(grouser_options INTERFACE -fPIE -fstack-protector-strong -fstack-clash-protection -fcf-protection)
target_compile_definitions(grouser_options INTERFACE _GLIBCXX_ASSERTIONS)
target_link_options(grouser_options INTERFACE -pie LINKER:-z,relro,-z,now,-z,noexecstack,-z,separate-code)
if(GROUSER_SANITIZE)
  target_compile_options(grouser_options INTERFACE -fsanitize=${GROUSER_SANITIZE} -fno-omit-frame-pointer
    $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized> -Wno-null-dereference)
  target_link_options(grouser_options INTERFACE -fsanitize=${GROUSER_SANITIZE})
  if(GROUSER_SANITIZE MATCHES undefined)
    target_compile_options(grouser_options INTERFACE -fno-sanitize-recover=all)  # else it tells, and goes on to exit code 0
  endif()
  if(GROUSER_SANITIZE MATCHES address)
    target_sources(grouser_options INTERFACE
      $<$<STREQUAL:$<TARGET_PROPERTY:TYPE>,EXECUTABLE>:${CMAKE_SOURCE_DIR}/tests/support/leaks_elsewhere.cpp>)
  endif()
else()
  # Sanitizers see more of the plain functions, and without optimisation glibc refuses it.
  target_compile_options(grouser_options INTERFACE $<$<NOT:$<CONFIG:Debug>>:-U_FORTIFY_SOURCE -D_FORTIFY_SOURCE=3>)
endif()

# grouser_made_quickly(NAME): code that computes little. Optimised, it takes the compiler half as long again with sanitizers. Fuzzers
# are to execute all of it as often as they can.
function(grouser_made_quickly name)
  if(GROUSER_SANITIZE AND NOT GROUSER_FUZZ)
    target_compile_options(${name} PRIVATE -O0)
  endif()
endfunction()

# grouser_library(NAME SOURCES ... HEADERS ... [PUBLIC libs] [PRIVATE libs]): one folder, one target.
function(grouser_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;HEADERS;PUBLIC;PRIVATE" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  target_sources(${name} PUBLIC FILE_SET HEADERS BASE_DIRS ${CMAKE_SOURCE_DIR} FILES ${ARG_HEADERS})
  target_link_libraries(${name} PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE} grouser_options)
endfunction()
