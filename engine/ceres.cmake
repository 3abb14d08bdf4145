# Ceres, whose dense problems Eigen solves here. Debian's names ATLAS besides BLAS and LAPACK, which any library of that name
# is: without it the program's package does not ask for ATLAS.
find_package(Ceres REQUIRED)
foreach(target Ceres::ceres ceres BLAS::BLAS LAPACK::LAPACK)
  if(NOT TARGET ${target})
    continue()
  endif()
  get_target_property(alias ${target} ALIASED_TARGET)
  get_target_property(libraries ${target} INTERFACE_LINK_LIBRARIES)
  if(libraries AND NOT alias)
    list(FILTER libraries EXCLUDE REGEX "/lib(f77blas|atlas)\\.(so|a)")
    set_target_properties(${target} PROPERTIES INTERFACE_LINK_LIBRARIES "${libraries}")
  endif()
endforeach()
