# sin, exp, pow and their kin of every executable come from musl's libm, taken out of the packaged libc.a. glibc chooses
# among variants with and without FMA when a program starts, so that the last bit of a sine, and with it a golden trace or
# a verdict, hangs on the machine. musl's are one piece of portable code: the same bits on every machine of an
# architecture, and as fast (tests/base/libm_test.cc; SLEEF's deterministic functions, the alternative, take three to
# seven times as long). What an executable defines, its shared libraries and plugins use as well, SUNDIALS among them.
# -DDYNOPROOF_LIBM=platform leaves the platform's; bits then differ from machine to machine.
set(DYNOPROOF_LIBM musl CACHE STRING "Where sin, exp and their kin come from: musl (same bits on every machine), platform")

if(DYNOPROOF_LIBM STREQUAL musl)
  find_file(DYNOPROOF_MUSL_LIBC libc.a PATHS /usr/lib/${CMAKE_SYSTEM_PROCESSOR}-linux-musl /usr/lib/musl/lib NO_DEFAULT_PATH)
  if(NOT DYNOPROOF_MUSL_LIBC)
    message(FATAL_ERROR "musl's libc.a is missing: install musl-dev, or configure with -DDYNOPROOF_LIBM=platform")
  endif()
  set(members
      sin cos sincos tan asin acos atan atan2 sinh cosh tanh asinh acosh atanh exp exp2 exp10 expm1 log log2 log10 log1p pow
      cbrt hypot erf tgamma cabs carg cexp clog cpow csqrt
      # what these call
      __sin __cos __tan __rem_pio2 __rem_pio2_large __expo2 __cexp exp_data exp2f_data log_data log2_data pow_data
      __math_divzero __math_invalid __math_oflow __math_uflow __math_xflow)
  list(TRANSFORM members APPEND .lo)
  set(folder ${PROJECT_BINARY_DIR}/libm)
  set(DYNOPROOF_LIBM_ARCHIVE ${folder}/libdynoproof_libm.a)
  file(REMOVE_RECURSE ${folder})
  file(MAKE_DIRECTORY ${folder})
  execute_process(COMMAND ${CMAKE_AR} x ${DYNOPROOF_MUSL_LIBC} ${members} WORKING_DIRECTORY ${folder} COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND ${CMAKE_AR} rcsD ${DYNOPROOF_LIBM_ARCHIVE} ${members} WORKING_DIRECTORY ${folder}
                  COMMAND_ERROR_IS_FATAL ANY)
  set(executable $<STREQUAL:$<TARGET_PROPERTY:TYPE>,EXECUTABLE>)
  add_link_options("$<${executable}:LINKER:--whole-archive,${DYNOPROOF_LIBM_ARCHIVE},--no-whole-archive>")
endif()
