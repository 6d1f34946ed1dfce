# Eigen: the system's, else the headers of the PyPI package cmeel-eigen, which lie under
# <site-packages>/cmeel.prefix; scikit-build-core puts site-packages on CMAKE_PREFIX_PATH.
find_package(Eigen3 3.4 QUIET CONFIG)
if(NOT Eigen3_FOUND)
  set(cmeel_prefixes ${CMAKE_PREFIX_PATH})
  list(TRANSFORM cmeel_prefixes APPEND /cmeel.prefix)
  find_package(Eigen3 3.4 QUIET CONFIG PATHS ${cmeel_prefixes})
endif()
if(NOT Eigen3_FOUND)
  message(FATAL_ERROR "Eigen 3.4 not found: install libeigen3-dev, or `pip install cmeel-eigen` "
                      "and put its site-packages on CMAKE_PREFIX_PATH")
endif()
message(STATUS "Eigen ${Eigen3_VERSION} from ${Eigen3_DIR}")

# SUNDIALS is optional. It is asked for without COMPONENTS, because the config file of version 6
# reports itself as not found whenever components are named; its targets are what counts.
set(STICKSLIP_ARKODE_LIBRARIES "")
if(STICKSLIP_WITH_SUNDIALS)
  find_package(SUNDIALS QUIET CONFIG)
  if(TARGET SUNDIALS::arkode_static AND TARGET SUNDIALS::nvecserial_static
     AND SUNDIALS_VERSION VERSION_GREATER_EQUAL 6 AND SUNDIALS_VERSION VERSION_LESS 8)
    set(STICKSLIP_ARKODE_LIBRARIES SUNDIALS::arkode_static SUNDIALS::nvecserial_static)
    message(STATUS "SUNDIALS ${SUNDIALS_VERSION} from ${SUNDIALS_DIR}")
  else()
    message(STATUS "SUNDIALS 6 or 7 (static) not found: building without ARKODE")
  endif()
endif()
